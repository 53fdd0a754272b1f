#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "section/section.h"

namespace clipgs {

/// What can be marked. A region is a circle, an outline a polygon; both lie in a face.
enum class MarkKind : std::uint8_t { kPoint, kLength, kAngle, kRegion, kOutline };

/// What somebody marked of a case, RAS mm. The twin of Mark in web/src/model/marks.ts.
struct Mark {
  MarkKind kind = MarkKind::kPoint;
  /// A point; both ends; an end, the vertex, the other end; the centre and a point of the rim; the
  /// corners.
  std::vector<glm::dvec3> points;
  glm::dvec3 normal{0};  ///< of the face that a region or an outline lies in, unit
  std::string name;      ///< "": it has none

  bool is_flat() const { return kind == MarkKind::kRegion || kind == MarkKind::kOutline; }
  /// Whether it is a line through its points, which is to be seen from end to end.
  bool is_line() const { return kind == MarkKind::kLength || kind == MarkKind::kAngle; }
};

/// Of a case: more could neither be seen nor told apart.
inline constexpr size_t kMostMarks = 500;
/// Of an outline.
inline constexpr size_t kMostCorners = 200;

/// A mark through these numbers, in the viewer's order: of flat ones the normal first. None where
/// they are too few, too many, or no direction.
std::optional<Mark> make_mark(MarkKind kind, const std::vector<double>& numbers);

/// Where what is said of a mark belongs to.
glm::dvec3 anchor_of(const Mark& mark);

/// Lines through which a mark is drawn, each from point to point.
std::vector<std::vector<glm::dvec3>> lines_of(const Mark& mark);

/// A mark by its name and what it measures, lengths first: "Nodule · 31.4 mm", "42.3°", "3.12 cm² ·
/// mean 45, SD 12 HU", "63 ± 4 HU". Without a section, what needs no values.
std::string mark_text(const Mark& mark, const Section* section);

}  // namespace clipgs
