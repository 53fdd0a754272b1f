#include "volume/dicom_phases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "volume/stack_plan.h"

namespace clipgs {
namespace {

using Slices = std::vector<DicomHeader>;

/// A value that may set images apart: by its number, by its text where it has none.
using Value = std::pair<double, std::string>;

Value number(const std::optional<double>& value) {
  return {value.value_or(-std::numeric_limits<double>::infinity()), ""};
}

/// mm, to the millimetre: stations lie centimetres apart.
Value at(double position) { return {std::round(position) + 0.0, ""}; }

struct Property {
  std::string_view name;
  std::string_view unit;
  std::function<Value(const DicomHeader&)> of;
  bool since_the_first = false;  ///< said as the difference to the least
};

const std::array<Property, 11>& properties() {
  static const std::array<Property, 11> kProperties{{
      {"foot-to-head position", " mm", [](const DicomHeader& h) { return at(h.position.z); }},
      {"right-to-left position", " mm", [](const DicomHeader& h) { return at(h.position.x); }},
      {"front-to-back position", " mm", [](const DicomHeader& h) { return at(h.position.y); }},
      {"temporal position", "",
       [](const DicomHeader& h) { return number(h.marks.temporal_position); }},
      {"temporal position", "",
       [](const DicomHeader& h) { return number(h.marks.temporal_index); }},
      {"trigger time", " ms", [](const DicomHeader& h) { return number(h.marks.trigger_ms); }},
      {"echo time", " ms", [](const DicomHeader& h) { return number(h.marks.echo_ms); }},
      {"b-value", " s/mm2", [](const DicomHeader& h) { return number(h.marks.b_value); }},
      {"acquisition", "", [](const DicomHeader& h) { return number(h.marks.acquisition); }},
      {"image type", "", [](const DicomHeader& h) { return Value(0, h.marks.image_type); }},
      {"acquired", " s after the first",
       [](const DicomHeader& h) { return number(h.marks.acquired_s); }, true},
  }};
  return kProperties;
}

/// The index of the place of each slice, from 0.
std::vector<size_t> places_of(const Slices& slices) {
  const glm::dvec3 normal = normal_of(slices.front());
  std::vector<size_t> places{0};
  size_t first = 0;  // slice at the place
  for (size_t i = 1; i < slices.size(); ++i) {
    const bool same = same_place(slices[first], slices[i], normal);
    places.push_back(places.back() + (same ? 0 : 1));
    first = same ? first : i;
  }
  return places;
}

/// Indices of slices, by what sets them apart.
using Groups = std::vector<std::vector<size_t>>;

/// Slices seen by one property.
class Sorting {
 public:
  Sorting(const Slices& slices, const Property& property) : places_(places_of(slices)) {
    values_at_.resize(places_.back() + 1);
    for (size_t i = 0; i < slices.size(); ++i) {
      values_.push_back(property.of(slices[i]));
      values_at_[places_[i]].insert(values_[i]);
    }
    for (const std::set<Value>& values : values_at_) {
      most_at_a_place_ = std::max(most_at_a_place_, values.size());
      least_at_a_place_ = std::min(least_at_a_place_, values.size());
    }
  }

  bool tells_apart() const { return most_at_a_place_ > 1; }
  const Value& value(size_t slice) const { return values_[slice]; }
  const Value& least() const { return *std::ranges::min_element(values_); }

  /// The phases that split_phases() describes, none if there is no telling.
  Groups phases() const {
    Groups by_value = grouped([&](size_t i) { return values_[i]; });
    if (std::ranges::all_of(by_value, [&](const auto& group) {
          return places_in(group).size() == values_at_.size();
        })) {
      return by_value;
    }
    if (most_at_a_place_ == least_at_a_place_) {
      return grouped([&](size_t i) {
        const std::set<Value>& values = values_at_[places_[i]];
        return std::distance(values.begin(), values.find(values_[i]));
      });
    }
    return overlap_as_phases(by_value) ? by_value : Groups();
  }

 private:
  template <typename Key>
  Groups grouped(const Key& key_of) const {
    std::map<decltype(key_of(0)), std::vector<size_t>> groups;
    for (size_t i = 0; i < values_.size(); ++i) {
      groups[key_of(i)].push_back(i);
    }
    Groups list;
    for (auto& [key, group] : groups) {
      list.push_back(std::move(group));
    }
    return list;
  }

  std::set<size_t> places_in(const std::vector<size_t>& group) const {
    std::set<size_t> places;
    for (const size_t i : group) {
      places.insert(places_[i]);
    }
    return places;
  }

  bool overlap_as_phases(const Groups& groups) const {
    if (2 * groups.size() > 3 * most_at_a_place_) {
      return false;
    }
    std::set<size_t> covered;  // by what could be a volume
    bool overlap = false;
    for (const std::vector<size_t>& group : groups) {
      const std::set<size_t> places = places_in(group);
      if (places.size() > 1) {
        covered.insert(places.begin(), places.end());
      }
      const auto shared =
          std::ranges::count_if(places, [&](size_t place) { return values_at_[place].size() > 1; });
      overlap = overlap || 2 * static_cast<size_t>(shared) >= places.size();
    }
    return overlap && 2 * covered.size() >= values_at_.size();
  }

  std::vector<size_t> places_;
  std::vector<Value> values_;
  std::vector<std::set<Value>> values_at_;  ///< by place
  size_t most_at_a_place_ = 0;
  size_t least_at_a_place_ = std::numeric_limits<size_t>::max();
};

/// What the group has in common; `least` is the least value of all, `rank` its place among others.
std::string name_of(const Property& property, const Sorting& sorting,
                    const std::vector<size_t>& group, const Value& least, const std::string& rank) {
  const auto [low, high] =
      std::ranges::minmax(group, {}, [&](size_t i) { return sorting.value(i); });
  const Value& from = sorting.value(low);
  const Value& to = sorting.value(high);
  if (!std::isfinite(from.first)) {
    return fmt::format("no {}", property.name);
  }
  if (!from.second.empty() || !to.second.empty()) {
    return fmt::format("{} {}", property.name, from.second);
  }
  const double zero = property.since_the_first && std::isfinite(least.first) ? least.first : 0;
  if (from == to) {
    return fmt::format("{} {:.6g}{}", property.name, from.first - zero, property.unit);
  }
  return fmt::format("{} ({} {:.6g} to {:.6g}{})", rank, property.name, from.first - zero,
                     to.first - zero, property.unit);
}

void split(Slices slices, size_t property, const std::string& name,
           std::vector<DicomPhase>& phases) {
  if (places_of(slices).back() + 1 < slices.size()) {
    for (; property < properties().size(); ++property) {
      const Property& by = properties()[property];
      const Sorting sorting(slices, by);
      const Groups groups = sorting.tells_apart() ? sorting.phases() : Groups();
      for (size_t g = 0; g < groups.size(); ++g) {
        Slices chosen;
        for (const size_t i : groups[g]) {
          chosen.push_back(slices[i]);
        }
        const std::string own = name_of(by, sorting, groups[g], sorting.least(),
                                        fmt::format("phase {} of {}", g + 1, groups.size()));
        split(std::move(chosen), property + 1,
              fmt::format("{}{}{}", name, name.empty() ? "" : ", ", own), phases);
      }
      if (!groups.empty()) {
        return;
      }
    }
  }
  phases.push_back({name, std::move(slices)});
}

}  // namespace

bool same_place(const DicomHeader& a, const DicomHeader& b, const glm::dvec3& normal) {
  constexpr double kSamePlace = 0.005;  // mm
  return std::abs(along_normal(a, normal) - along_normal(b, normal)) < kSamePlace;
}

std::vector<DicomPhase> split_phases(std::vector<DicomHeader> slices) {
  std::vector<DicomPhase> phases;
  split(std::move(slices), 0, "", phases);
  return phases;
}

}  // namespace clipgs
