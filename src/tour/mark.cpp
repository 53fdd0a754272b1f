#include "tour/mark.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "tour/region.h"

namespace clipgs {

namespace {

using glm::dvec3;

constexpr int kCirclePoints = 64;

/// Of each kind; of an outline, at least.
constexpr std::array<size_t, 5> kPointsOf = {1, 2, 3, 2, 3};

/// With a minus of its own width, and no negative zero.
std::string decimal(double value, int digits) {
  const std::string text = fmt::format("{:.{}f}", value, digits);
  const bool is_zero = text.find_first_not_of("-0.") == std::string::npos;
  return text.front() != '-' ? text : (is_zero ? "" : "\u2212") + text.substr(1);
}

const char* unit_of(const Section& section) {
  return section.modality == Modality::kCt ? " HU" : "";
}

double degrees_of(const Mark& angle) {
  const dvec3 a = angle.points[0] - angle.points[1];
  const dvec3 b = angle.points[2] - angle.points[1];
  const double lengths = glm::length(a) * glm::length(b);
  const double cosine = lengths > 0 ? glm::dot(a, b) / lengths : 1;
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
}

std::string area_text(double mm2) {
  return mm2 < 100 ? decimal(mm2, 0) + " mm²" : decimal(mm2 / 100, 2) + " cm²";
}

std::vector<std::string> measures(const Mark& mark, const Section* section) {
  std::vector<std::string> parts;
  if (mark.kind == MarkKind::kLength) {
    parts.push_back(decimal(glm::distance(mark.points[0], mark.points[1]), 1) + " mm");
  } else if (mark.kind == MarkKind::kAngle) {
    parts.push_back(decimal(degrees_of(mark), 1) + "°");
  } else if (mark.is_flat()) {
    parts.push_back(area_text(region_area(mark)));
    if (const auto values = section != nullptr ? region_values(mark, *section) : std::nullopt) {
      parts.push_back(fmt::format("mean {}, SD {}{}", decimal(values->mean, 0),
                                  decimal(values->deviation, 0), unit_of(*section)));
    }
  } else if (const auto reading =
                 section != nullptr ? section->read(Vec3(mark.points[0])) : std::nullopt) {
    const auto error = static_cast<double>(reading->error);
    parts.push_back(fmt::format("{} ± {}{}", decimal(static_cast<double>(reading->value), 0),
                                decimal(error, error < 0.95 ? 1 : 0), unit_of(*section)));
  }
  return parts;
}

std::vector<dvec3> circle(const Mark& region) {
  const dvec3 out = region.points[1] - region.points[0];
  const dvec3 across = glm::cross(region.normal, out);
  std::vector<dvec3> line;
  for (int i = 0; i <= kCirclePoints; ++i) {
    const double turn = 2 * std::numbers::pi * i / kCirclePoints;
    line.push_back(region.points[0] + std::cos(turn) * out + std::sin(turn) * across);
  }
  return line;
}

}  // namespace

std::optional<Mark> make_mark(MarkKind kind, const std::vector<double>& numbers) {
  Mark mark;
  mark.kind = kind;
  for (size_t i = 0; i + 2 < numbers.size(); i += 3) {
    mark.points.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
  }
  if (mark.is_flat() && !mark.points.empty()) {
    const double length = glm::length(mark.points.front());
    if (length == 0) {
      return std::nullopt;
    }
    mark.normal = mark.points.front() / length;
    mark.points.erase(mark.points.begin());
  }
  const size_t least = kPointsOf.at(static_cast<size_t>(kind));
  const size_t most = kind == MarkKind::kOutline ? kMostCorners : least;
  const bool is_whole = numbers.size() % 3 == 0 && mark.points.size() >= least;
  return is_whole && mark.points.size() <= most ? std::optional(std::move(mark)) : std::nullopt;
}

dvec3 anchor_of(const Mark& mark) {
  if (mark.kind == MarkKind::kAngle) {
    return mark.points[1];
  }
  if (mark.kind == MarkKind::kRegion || mark.kind == MarkKind::kPoint) {
    return mark.points[0];
  }
  dvec3 sum(0);
  for (const dvec3& point : mark.points) {
    sum += point;
  }
  return sum / static_cast<double>(mark.points.size());
}

std::vector<std::vector<dvec3>> lines_of(const Mark& mark) {
  if (mark.kind == MarkKind::kPoint) {
    return {};
  }
  if (mark.kind == MarkKind::kRegion) {
    return {circle(mark)};
  }
  std::vector<dvec3> line = mark.points;
  if (mark.kind == MarkKind::kOutline) {
    line.push_back(line.front());
  }
  return {line};
}

std::string mark_text(const Mark& mark, const Section* section) {
  std::vector<std::string> parts = measures(mark, section);
  if (!mark.name.empty()) {
    parts.insert(parts.begin(), mark.name);
  }
  // Only of a point there may be nothing to say.
  return parts.empty() ? "Point" : fmt::format("{}", fmt::join(parts, " · "));
}

}  // namespace clipgs
