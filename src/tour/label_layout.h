#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/geometry.h"

namespace clipgs {

/// A label, the place that it is about, and from point to point the line there, which no label is
/// to cover. px from the top left of a picture.
struct Label {
  glm::dvec2 anchor{0};
  glm::dvec2 size{0};
  std::vector<glm::dvec2> line;
};

/// A label's top left corner, and which of the places around its anchor that is.
struct LaidLabel {
  glm::dvec2 at{0};
  size_t choice = 0;
};

/// Labels in a picture of that size, which keep clear of each other, of all anchors and lines and
/// of its edges where there is room: the earlier ones first. A label goes where it was `before`
/// while that is clear, so that labels do not jump. The twin of web/src/model/label_layout.ts.
std::vector<LaidLabel> lay_out(std::span<const Label> labels, const glm::dvec2& picture,
                               std::span<const std::optional<size_t>> before = {});

}  // namespace clipgs
