#include "cli/draw_marks.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tour/label_layout.h"

#include "cli/text_box.h"
#include "core/draw_text.h"
#include "core/utf8.h"

namespace clipgs {

namespace {

using glm::dvec2;
using glm::dvec3;

/// A point that lies so near to a face lies on it, mm.
constexpr float kReach = 1;
constexpr double kFaint = 0.35;

// px of a picture whose letters have the size of those on the viewer's page.
constexpr double kLetters = 12;
constexpr double kDot = 5;
constexpr double kLine = 2;
constexpr double kRim = 4;
/// A label that is farther from what it is about has a line to it.
constexpr double kLeader = 14;
constexpr double kWidest = 260;
constexpr size_t kMostBytes = 400;  // that can be so wide
/// More labels than these hide what they are about: those on faces that are seen come first.
constexpr size_t kMostLabels = 100;

/// A mark in a picture.
struct SeenMark {
  SaidMark* said;
  std::vector<dvec2> points;
  Label label;
  std::string text;  ///< as much of it as there is room for
  double opacity;
};

class MarksPainter {
 public:
  MarksPainter(const Overlay& overlay, const Image& picture, const Camera& camera)
      : cairo_(overlay.cairo()),
        unit_(std::max(9.0, 0.018 * std::min(picture.width, picture.height)) / kLetters),
        size_(dvec2(picture.width, picture.height) / unit_),
        camera_(camera) {
    cairo_scale(cairo_, unit_, unit_);
    cairo_set_line_join(cairo_, CAIRO_LINE_JOIN_ROUND);
  }

  const dvec2& size() const { return size_; }

  /// Where a point is; nothing behind the camera.
  std::optional<dvec2> place_of(const dvec3& point) const {
    const Vec3 local = camera_.to_camera(Vec3(point));
    if (local.z <= 0) {
      return std::nullopt;
    }
    return dvec2(camera_.fx * local.x / local.z + camera_.cx,
                 camera_.fy * local.y / local.z + camera_.cy) /
           unit_;
  }

  std::optional<SeenMark> seen(SaidMark& said, double opacity) const {
    SeenMark mark{&said, {}, {}, shortened(said.text), opacity};
    for (const dvec3& point : said.mark.points) {
      const std::optional<dvec2> place = place_of(point);
      if (!place) {
        return std::nullopt;
      }
      mark.points.push_back(*place);
    }
    const std::optional<dvec2> anchor = place_of(anchor_of(said.mark));
    if (!anchor) {
      return std::nullopt;
    }
    const TextBox box(cairo_, {mark.text}, kLetters, false);
    mark.label = {*anchor,
                  {box.width(), box.height()},
                  said.mark.is_line() ? mark.points : std::vector<dvec2>()};
    return mark;
  }

  void draw(const SeenMark& mark) const {
    for (const std::vector<dvec3>& line : lines_of(mark.said->mark)) {
      draw_line(line, mark.opacity);
    }
    for (const dvec2& point : mark.points) {
      cairo_new_sub_path(cairo_);
      cairo_arc(cairo_, point.x, point.y, kDot, 0, 2 * std::numbers::pi);
      stroke(mark.opacity, kLine);
    }
  }

  void draw_label(const SeenMark& mark, const LaidLabel& laid) const {
    draw_leader(mark, laid);
    TextBox(cairo_, {mark.text}, kLetters, false).draw(laid.at.x, laid.at.y, mark.opacity);
  }

 private:
  std::string shortened(const std::string& text) const {
    if (text.size() <= kMostBytes && width_of(cairo_, text, kLetters) <= kWidest) {
      return text;
    }
    std::string result = utf8_beginning(text, kMostBytes);
    while (!result.empty() && width_of(cairo_, result + "…", kLetters) > kWidest) {
      result = utf8_beginning(result, result.size() - 1);
    }
    return result + "…";
  }

  void draw_leader(const SeenMark& mark, const LaidLabel& laid) const {
    const dvec2& anchor = mark.label.anchor;
    const dvec2 to = glm::clamp(anchor, laid.at, laid.at + mark.label.size);
    if (glm::distance(anchor, to) > kLeader) {
      cairo_move_to(cairo_, anchor.x, anchor.y);
      cairo_line_to(cairo_, to.x, to.y);
      stroke(mark.opacity, 1);
    }
  }

  /// Of a line of which a point is not seen, nothing.
  void draw_line(const std::vector<dvec3>& line, double opacity) const {
    cairo_new_path(cairo_);
    for (const dvec3& point : line) {
      const std::optional<dvec2> place = place_of(point);
      if (!place) {
        return;
      }
      cairo_line_to(cairo_, place->x, place->y);
    }
    stroke(opacity, kLine);
  }

  /// White with a dark rim, so that it is seen on anything.
  void stroke(double opacity, double width) const {
    cairo_set_source_rgba(cairo_, 0, 0, 0, 0.73 * opacity);
    cairo_set_line_width(cairo_, width + kRim - kLine);
    cairo_stroke_preserve(cairo_);
    cairo_set_source_rgba(cairo_, 1, 1, 1, opacity);
    cairo_set_line_width(cairo_, width);
    cairo_stroke(cairo_);
    cairo_new_path(cairo_);
  }

  cairo_t* cairo_;
  double unit_;  // px of the picture
  dvec2 size_;
  const Camera& camera_;
};

/// Those whose labels there is room for, in their order.
std::vector<SeenMark*> with_labels(std::vector<SeenMark>& seen) {
  std::vector<SeenMark*> marks;
  marks.reserve(seen.size());
  for (SeenMark& mark : seen) {
    marks.push_back(&mark);
  }
  if (marks.size() > kMostLabels) {
    std::ranges::stable_sort(marks, std::ranges::greater(), &SeenMark::opacity);
    marks.resize(kMostLabels);
    std::ranges::sort(marks);
  }
  return marks;
}

bool is_inside(const Section& section, const Vec3& point) {
  const Vec3 index = section.index_from_world(point);
  const Vec3 slack = kReach / section.spacing;
  return glm::all(glm::greaterThanEqual(index, -slack)) &&
         glm::all(glm::lessThanEqual(index, Vec3(section.dims - 1) + slack));
}

/// Whether a point lies on a face that the camera sees. As picking.ts has it.
bool is_on_face(const Section& section, std::span<const Plane> planes, const Camera& camera,
                const Vec3& point) {
  const bool is_near = std::ranges::any_of(planes, [&](const Plane& plane) {
    return plane.signed_distance(camera.position) < 0 &&
           std::abs(plane.signed_distance(point)) <= kReach;
  });
  const bool is_kept = std::ranges::all_of(
      planes, [&](const Plane& plane) { return plane.signed_distance(point) >= -kReach; });
  return is_near && is_kept && is_inside(section, point);
}

}  // namespace

std::vector<SaidMark> said_marks(std::vector<Mark> marks, const Section* section) {
  std::vector<SaidMark> said;
  for (Mark& mark : marks) {
    std::string text = mark_text(mark, section);
    said.push_back({std::move(mark), std::move(text), std::nullopt});
  }
  // Lengths come first where there is little room.
  std::ranges::stable_partition(
      said, [](const SaidMark& one) { return one.mark.kind != MarkKind::kPoint; });
  return said;
}

void draw_marks(Image& picture, std::span<SaidMark> marks, const Camera& camera, const Cut& cut,
                const Section* section, bool body) {
  std::vector<Plane> planes(cut.planes().begin(), cut.planes().end());
  if (section != nullptr && body) {
    const std::vector<Plane> ends = section->ends();
    planes.insert(planes.end(), ends.begin(), ends.end());
  }
  const Overlay overlay(picture.width, picture.height);
  const MarksPainter painter(overlay, picture, camera);
  std::vector<SeenMark> seen;
  for (SaidMark& said : marks) {
    const bool on_face =
        section != nullptr && std::ranges::any_of(said.mark.points, [&](const dvec3& point) {
          return is_on_face(*section, planes, camera, Vec3(point));
        });
    if (auto mark = painter.seen(said, on_face ? 1 : kFaint)) {
      seen.push_back(std::move(*mark));
    }
  }
  const std::vector<SeenMark*> labelled = with_labels(seen);
  std::vector<Label> labels;
  std::vector<std::optional<size_t>> before;
  for (const SeenMark* const mark : labelled) {
    labels.push_back(mark->label);
    before.push_back(mark->said->choice);
  }
  const std::vector<LaidLabel> laid = lay_out(labels, painter.size(), before);
  for (const SeenMark& mark : seen) {
    painter.draw(mark);
  }
  for (size_t i = 0; i < laid.size(); ++i) {
    labelled[i]->said->choice = laid[i].choice;
    painter.draw_label(*labelled[i], laid[i]);
  }
  overlay.put_over(picture);
}

}  // namespace clipgs
