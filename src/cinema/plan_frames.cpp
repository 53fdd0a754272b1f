#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

#include "cinema/choose_frames.h"
#include "cinema/make_dataset.h"
#include "core/random.h"

namespace clipgs {
namespace {

constexpr float kAxisShare = 0.40f;        // of the training frames
constexpr float kObliqueShare = 0.45f;     // the rest is uncut
constexpr float kFaceSeen = 0.75f;         // of the frames with a plane show its face
constexpr float kLeastKept = 0.15f;        // of the extent along the normal
constexpr Vec2 kTrainRange{0.04f, 0.96f};  // of the extent that training planes cover …
constexpr Vec2 kTestRange{0.10f, 0.90f};   // … and test planes
// The same of axis planes that keep what is below them: at least kLeastKept is left.
constexpr Vec2 kTrainRangeBelow{kLeastKept, 0.96f};
constexpr Vec2 kTestRangeBelow{kLeastKept + 0.02f, 0.90f};
// Distances of training cameras, relative to the nominal one; that comes twice as often.
constexpr std::array<float, 4> kDistances{1.0f, 0.8f, 1.0f, 1.2f};

// Distance of test planes from training's, in mean distances of training's axis planes.
constexpr float kHeldOut = 0.2f;

// Frames that are planned besides to choose from, as a multiple of the training frames.
constexpr int kOthers = 4;

enum Kind : size_t { kAxis, kOblique, kUncut, kKinds };

// Independent random streams of a plan.
enum Stream : std::uint64_t { kTraining = 1, kTestAxis, kTestOblique, kOtherTraining };

float lerp(const Vec2& range, float t) { return range.x + (range.y - range.x) * t; }

Vec3 random_direction(Rng& rng) {
  const float z = 2.0f * rng.uniform() - 1.0f;
  const float r = std::sqrt(std::max(0.0f, 1.0f - z * z));
  const float phi = 6.2831853f * rng.uniform();
  return {r * std::cos(phi), r * std::sin(phi), z};
}

Mat3 random_rotation(Rng& rng) {
  Mat3 rotation;
  rotation[2] = random_direction(rng);
  Vec3 a;
  Vec3 b;
  orthonormal_basis(rotation[2], a, b);
  const float turn = 6.2831853f * rng.uniform();
  rotation[0] = std::cos(turn) * a + std::sin(turn) * b;
  rotation[1] = glm::cross(rotation[2], rotation[0]);
  return rotation;
}

template <typename T>
void shuffle(std::vector<T>& list, Rng& rng) {
  for (size_t i = list.size(); i > 1; --i) {
    std::swap(list[i - 1], list[rng.below(static_cast<std::uint32_t>(i))]);
  }
}

class Planner {
 public:
  Planner(const VisibleMatter& matter, const DatasetOptions& options)
      : matter_(matter), options_(options) {}

  std::vector<Frame> plan() {
    Rng rng(options_.seed, kTraining);
    frames_ = training_frames(options_.train_frames, rng);
    for (const Frame& frame : frames_) {
      if (kind_of(frame) == kAxis) {
        axis_offsets_.push_back(axis_offset(frame));
      }
    }
    plan_test(Split::kTestAxis);
    plan_test(Split::kTestOblique);
    return std::move(frames_);
  }

  /// The training frames of a plan and others, to choose as many of each kind and distance from.
  FramePool pool(const std::vector<Frame>& plan) const {
    FramePool pool;
    pool.quotas.assign(kKinds * kDistances.size(), 0);
    std::vector<float> test_offsets;
    for (const Frame& frame : plan) {
      if (frame.split == Split::kTrain) {
        pool.frames.push_back(frame);
        ++pool.quotas[group_of(frame)];
      } else if (frame.split == Split::kTestAxis) {
        test_offsets.push_back(axis_offset(frame));
      }
    }
    Rng rng(options_.seed, kOtherTraining);
    const int others = kOthers * options_.train_frames;
    for (Frame& frame : training_frames(others, rng)) {
      if (kind_of(frame) != kAxis || !near_any(test_offsets, axis_offset(frame))) {
        pool.frames.push_back(std::move(frame));
      }
    }
    for (const Frame& frame : pool.frames) {
      pool.groups.push_back(group_of(frame));
    }
    return pool;
  }

 private:
  Kind kind_of(const Frame& frame) const {
    if (!frame.plane) {
      return kUncut;
    }
    // A random direction is never this near to the axis.
    return std::abs(glm::dot(frame.plane->normal, options_.axis)) > 0.999999f ? kAxis : kOblique;
  }

  /// Frames of a group are alike in kind and distance: nearer pictures show more, and cost more.
  size_t group_of(const Frame& frame) const {
    const float distance = glm::length(frame.camera.position - matter_.sphere.center) /
                           framing_distance(matter_.sphere.radius);
    const auto* const nearest = std::ranges::min_element(
        kDistances, {}, [&](float candidate) { return std::abs(candidate - distance); });
    return kind_of(frame) * kDistances.size() + static_cast<size_t>(nearest - kDistances.begin());
  }

  /// Along +axis, of a frame with an axis plane.
  float axis_offset(const Frame& frame) const {
    return glm::dot(frame.plane->normal, options_.axis) * frame.plane->offset;
  }

  std::vector<Frame> training_frames(int count, Rng& rng) const {
    std::vector<Frame> frames;
    const Mat3 rotation = random_rotation(rng);
    // Kinds in turn along the spiral of cameras, so that each kind sees all sides. √2 is unrelated
    // to the spiral's golden angle.
    std::vector<Kind> kinds;
    int axis_count = 0;
    for (int i = 0; i < count; ++i) {
      const auto turn = static_cast<float>(std::fmod(i * 0.41421356 + 0.5, 1.0));
      kinds.push_back(turn < kAxisShare                   ? kAxis
                      : turn < kAxisShare + kObliqueShare ? kOblique
                                                          : kUncut);
      axis_count += kinds.back() == kAxis ? 1 : 0;
    }
    // One axis plane in each of as many equal steps.
    std::vector<float> heights;
    heights.reserve(static_cast<size_t>(axis_count));
    for (int i = 0; i < axis_count; ++i) {
      heights.push_back((static_cast<float>(i) + rng.uniform()) / static_cast<float>(axis_count));
    }
    shuffle(heights, rng);
    for (int i = 0; i < count; ++i) {
      const float distance = kDistances[rng.below(kDistances.size())];
      Frame frame = make_frame(Split::kTrain, i, rotation * fibonacci_sphere(i, count), distance);
      if (kinds[static_cast<size_t>(i)] == kAxis) {
        const Vec2 range = options_.one_sided ? kTrainRangeBelow : kTrainRange;
        set_axis_plane(frame, lerp(range, heights.back()), rng);
        heights.pop_back();
      } else if (kinds[static_cast<size_t>(i)] == kOblique) {
        const Vec3 normal = random_direction(rng);
        frame.plane = make_plane(normal, lerp(kTrainRange, rng.uniform()), frame.camera, rng);
      }
      frames.push_back(frame);
    }
    return frames;
  }

  void plan_test(Split split) {
    const bool axis = split == Split::kTestAxis;
    Rng rng(options_.seed, axis ? kTestAxis : kTestOblique);
    const Mat3 rotation = random_rotation(rng);
    const int count = options_.test_frames;
    std::vector<int> cameras(static_cast<size_t>(count));
    std::iota(cameras.begin(), cameras.end(), 0);
    shuffle(cameras, rng);
    for (int i = 0; i < count; ++i) {
      Frame frame = make_frame(
          split, i, rotation * fibonacci_sphere(cameras[static_cast<size_t>(i)], count), 1.0f);
      const float step = (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
      if (axis) {
        const Vec2 range = options_.one_sided ? kTestRangeBelow : kTestRange;
        set_axis_plane(frame, held_out(lerp(range, step)), rng);
      } else {
        const Vec3 normal = random_direction(rng);
        frame.plane = make_plane(normal, lerp(kTestRange, rng.uniform()), frame.camera, rng);
      }
      frame.uncut_file = fmt::format("uncut/{}_{:04}.png", split_name(split), i);
      frame.depth_file = fmt::format("depth/{}_{:04}.png", split_name(split), i);
      frames_.push_back(frame);
    }
  }

  Frame make_frame(Split split, int number, const Vec3& direction, float distance) const {
    Frame frame;
    const Sphere& sphere = matter_.sphere;
    frame.camera = look_at(sphere.center + framing_distance(sphere.radius) * distance * direction,
                           sphere.center, Vec3(0, 0, 1), options_.size, options_.size);
    frame.split = split;
    frame.file = fmt::format("images/{}_{:04}.png", split_name(split), number);
    return frame;
  }

  // A plane across the axis. One that must keep what is below cannot suit the camera: the camera
  // then moves to the other end of the axis if it stands on the wrong one.
  void set_axis_plane(Frame& frame, float height, Rng& rng) const {
    if (!options_.one_sided) {
      frame.plane = make_plane(options_.axis, height, frame.camera, rng);
      return;
    }
    const Vec3& axis = options_.axis;
    const Plane plane = Plane{axis, lerp(matter_.extent(axis), height)}.flipped();
    const bool hides_face = plane.signed_distance(frame.camera.position) >= 0;
    const bool show_face = rng.uniform() < kFaceSeen;
    if (hides_face == show_face) {
      const Vec3& center = matter_.sphere.center;
      const Vec3 arm = frame.camera.position - center;
      frame.camera = look_at(center + arm - 2 * glm::dot(arm, axis) * axis, center, Vec3(0, 0, 1),
                             options_.size, options_.size);
    }
    frame.plane = plane;
  }

  // A plane at `height` of the matter's extent along `normal`, keeping the side that suits.
  Plane make_plane(const Vec3& normal, float height, const Camera& camera, Rng& rng) const {
    Plane plane{normal, lerp(matter_.extent(normal), height)};
    const bool hides_face = plane.signed_distance(camera.position) >= 0;
    const bool show_face = rng.uniform() < kFaceSeen;
    float kept = 1.0f - height;
    if (hides_face == show_face) {
      plane = plane.flipped();
      kept = height;
    }
    return kept < kLeastKept ? plane.flipped() : plane;
  }

  // Height, as a share of the extent along the axis, that two planes differ by at least.
  float least_step() const {
    return kHeldOut / static_cast<float>(std::max<size_t>(1, axis_offsets_.size()));
  }

  // Whether an axis plane at `offset` would be as good as one of the others.
  bool near_any(const std::vector<float>& others, float offset) const {
    const Vec2 extent = matter_.extent(options_.axis);
    const float least = least_step() * (extent.y - extent.x);
    return std::ranges::any_of(others,
                               [&](float other) { return std::abs(other - offset) < least; });
  }

  // The height moved, if need be, so that its plane is none of training's.
  float held_out(float height) const {
    const Vec2 extent = matter_.extent(options_.axis);
    while (near_any(axis_offsets_, lerp(extent, height))) {
      height += 0.7f * least_step();
    }
    return height;
  }

  const VisibleMatter& matter_;
  const DatasetOptions& options_;
  std::vector<Frame> frames_;
  std::vector<float> axis_offsets_;  // of the training planes, along +axis
};

}  // namespace

std::vector<Frame> plan_frames(const VisibleMatter& matter, const DatasetOptions& options) {
  return Planner(matter, options).plan();
}

std::vector<Frame> plan_frames(const CinemaScene& scene, const VisibleMatter& matter,
                               const DatasetOptions& options) {
  Planner planner(matter, options);
  std::vector<Frame> frames = planner.plan();
  const FramePool pool = planner.pool(frames);
  const std::vector<size_t> chosen = choose_frames(scene, matter.sphere, pool);
  for (size_t i = 0; i < chosen.size(); ++i) {
    std::string file = std::move(frames[i].file);
    frames[i] = pool.frames[chosen[i]];
    frames[i].file = std::move(file);
  }
  return frames;
}

}  // namespace clipgs
