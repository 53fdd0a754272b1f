#include "cli/animation.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "asset/webp_animation.h"
#include "core/file.h"
#include "core/progress.h"

namespace clipgs {
namespace {

/// Moves the first plane, or slab, so that it begins at `offset`.
Cut moved(const Cut& cut, float offset) {
  std::vector<Plane> planes(cut.planes().begin(), cut.planes().end());
  const float distance = offset - planes[0].offset;
  planes[0].offset = offset;
  if (planes.size() > 1 && are_opposite(planes[0], planes[1])) {
    planes[1].offset -= distance;
  }
  return Cut(std::move(planes));
}

struct AnimationFrame {
  View view;
  Cut cut;
};

AnimationFrame animation_frame(const AnimationArguments& animation, int frame, const View& view,
                               const Cut& cut, const std::function<Vec2(const Vec3&)>& extent) {
  // The last picture comes just before the first one again.
  const float share = static_cast<float>(frame) / static_cast<float>(animation.frames);
  AnimationFrame result{view, cut};
  if (animation.turntable) {
    result.view.azimuth_deg += 360 * share;
  }
  if (animation.sweep) {
    constexpr float kDeepest = 0.92f;  // of the way: beyond it little is left to see
    const Cut start = cut.empty() ? Cut(Plane{Vec3(0, 0, -1), 0}) : cut;
    const Vec2 interval = extent(start.planes()[0].normal);
    const float depth = 0.5f * kDeepest * (1 - std::cos(2 * std::numbers::pi_v<float> * share));
    result.cut = moved(start, glm::mix(interval.x, interval.y, depth));
  }
  return result;
}

}  // namespace

void add_animation_options(CLI::App& command, AnimationArguments& animation) {
  command.add_flag("--turntable", animation.turntable,
                   "Animated WebP: the camera goes once around the patient");
  command.add_flag("--sweep", animation.sweep,
                   "Animated WebP: the first plane or slab goes through what is visible, and back");
  command.add_option("--frames", animation.frames, "Pictures of an animation")
      ->check(CLI::Range(2, 10000))
      ->capture_default_str();
  command.add_option("--fps", animation.fps, "Pictures a second, of a tour, too")
      ->check(CLI::Range(0.1, 100.0))
      ->capture_default_str();
}

void check_picture_output(const AnimationArguments& animation,
                          const std::filesystem::path& output) {
  if (animation.any() && output.extension() != ".webp") {
    throw CLI::ValidationError(
        "-o", "what moves is written as a WebP: give a file name that ends in .webp");
  }
  if (!animation.any() && output.extension() != ".png") {
    throw CLI::ValidationError(
        "-o", "what stands still is written as a PNG: give a file name that ends in .png");
  }
}

void write_animation(const std::filesystem::path& output, const std::string& label,
                     const AnimationArguments& animation, const View& view, const Cut& cut,
                     const std::function<Vec2(const Vec3&)>& extent,
                     const std::function<Image(const View&, const Cut&)>& draw) {
  constexpr float kQuality = 80;
  WebpAnimation pictures(animation.fps, kQuality);
  Progress progress(label, static_cast<size_t>(animation.frames));
  for (int i = 0; i < animation.frames; ++i) {
    const AnimationFrame frame = animation_frame(animation, i, view, cut, extent);
    pictures.add(draw(frame.view, frame.cut));
    progress.update(static_cast<size_t>(i) + 1);
  }
  const Bytes bytes = pictures.finish();
  write_file(output, bytes.data(), bytes.size());
}

}  // namespace clipgs
