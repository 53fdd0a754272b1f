#include "tour/label_layout.h"

#include <algorithm>

namespace clipgs {

namespace {

using glm::dvec2;

/// Between a label and its anchor, and between labels, px.
constexpr double kGap = 9;
constexpr double kApart = 3;
/// How much of an anchor's dot no label is to cover, px.
constexpr double kDot = 6;
/// How wide lines are that no label is to cover, px.
constexpr double kLine = 6;

struct LabelBox {
  dvec2 at;
  dvec2 size;
};

/// To the right first, then around the anchor, nearer places before farther ones.
std::vector<dvec2> candidates(const Label& label) {
  const auto [x, y] = std::pair(label.anchor.x, label.anchor.y);
  const auto [width, height] = std::pair(label.size.x, label.size.y);
  std::vector<dvec2> places;
  for (const double gap : {kGap, kGap + height + kApart, kGap + 2 * (height + kApart)}) {
    places.insert(places.end(), {{x + gap, y - 0.5 * height},
                                 {x - gap - width, y - 0.5 * height},
                                 {x - 0.5 * width, y - gap - height},
                                 {x - 0.5 * width, y + gap},
                                 {x + gap, y - gap - height},
                                 {x - gap - width, y - gap - height},
                                 {x + gap, y + gap},
                                 {x - gap - width, y + gap}});
  }
  return places;
}

/// px².
double overlap(const LabelBox& a, const LabelBox& b) {
  const dvec2 common = glm::min(a.at + a.size, b.at + b.size) - glm::max(a.at, b.at);
  return common.x > 0 && common.y > 0 ? common.x * common.y : 0;
}

/// The shares of the way from `begin` to `end` at which an interval is entered and left.
std::pair<double, double> shares_within(double low, double size, double begin, double end) {
  if (begin == end) {
    return low <= begin && begin <= low + size ? std::pair(0.0, 1.0) : std::pair(1.0, 0.0);
  }
  return std::minmax({(low - begin) / (end - begin), (low + size - begin) / (end - begin)});
}

/// How much of a straight line lies within a box, px.
double within(const LabelBox& box, const dvec2& from, const dvec2& to) {
  const auto across = shares_within(box.at.x, box.size.x, from.x, to.x);
  const auto down = shares_within(box.at.y, box.size.y, from.y, to.y);
  const double share =
      std::min({1.0, across.second, down.second}) - std::max({0.0, across.first, down.first});
  return std::max(0.0, share) * glm::distance(from, to);
}

}  // namespace

std::vector<LaidLabel> lay_out(std::span<const Label> labels, const dvec2& picture,
                               std::span<const std::optional<size_t>> before) {
  std::vector<LabelBox> placed;
  std::vector<LaidLabel> laid;
  for (size_t i = 0; i < labels.size(); ++i) {
    const Label& label = labels[i];
    const std::vector<dvec2> places = candidates(label);
    const auto cost = [&](const dvec2& at) {
      const LabelBox box{at, label.size};
      const LabelBox wide{at - kApart, label.size + 2 * kApart};
      double sum = 2 * (label.size.x * label.size.y - overlap(box, {dvec2(0), picture}));
      for (const LabelBox& other : placed) {
        sum += overlap(wide, other);
      }
      for (const Label& other : labels) {
        sum += overlap(box, {other.anchor - kDot, dvec2(2 * kDot)});
        for (size_t k = 1; k < other.line.size(); ++k) {
          sum += kLine * within(box, other.line[k - 1], other.line[k]);
        }
      }
      return sum;
    };
    const std::optional<size_t> last = i < before.size() ? before[i] : std::nullopt;
    size_t choice = 0;
    if (last && cost(places[*last]) == 0) {
      choice = *last;
    } else {
      std::vector<double> costs(places.size());
      std::ranges::transform(places, costs.begin(), cost);
      choice = static_cast<size_t>(std::ranges::min_element(costs) - costs.begin());
    }
    placed.push_back({places[choice], label.size});
    laid.push_back({places[choice], choice});
  }
  return laid;
}

}  // namespace clipgs
