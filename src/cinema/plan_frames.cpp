#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

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
// Distances of training cameras, relative to the nominal one; that comes twice as often.
constexpr std::array<float, 4> kDistances{1.0f, 0.8f, 1.0f, 1.2f};

// Distance of test planes from training's, in mean distances of training's axis planes.
constexpr float kHeldOut = 0.2f;

enum class Kind { kAxis, kOblique, kUncut };

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
    plan_training();
    plan_test(Split::kTestAxis);
    plan_test(Split::kTestOblique);
    return std::move(frames_);
  }

 private:
  void plan_training() {
    Rng rng(options_.seed, 1);
    const int count = options_.train_frames;
    const Mat3 rotation = random_rotation(rng);
    // Kinds in turn along the spiral of cameras, so that each kind sees all sides. √2 is unrelated
    // to the spiral's golden angle.
    std::vector<Kind> kinds;
    int axis_count = 0;
    for (int i = 0; i < count; ++i) {
      const auto turn = static_cast<float>(std::fmod(i * 0.41421356 + 0.5, 1.0));
      kinds.push_back(turn < kAxisShare                   ? Kind::kAxis
                      : turn < kAxisShare + kObliqueShare ? Kind::kOblique
                                                          : Kind::kUncut);
      axis_count += kinds.back() == Kind::kAxis ? 1 : 0;
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
      if (kinds[static_cast<size_t>(i)] == Kind::kAxis) {
        const float height = lerp(kTrainRange, heights.back());
        heights.pop_back();
        frame.plane = make_plane(options_.axis, height, frame.camera, rng);
        axis_offsets_.push_back(glm::dot(frame.plane->normal, options_.axis) * frame.plane->offset);
      } else if (kinds[static_cast<size_t>(i)] == Kind::kOblique) {
        const Vec3 normal = random_direction(rng);
        frame.plane = make_plane(normal, lerp(kTrainRange, rng.uniform()), frame.camera, rng);
      }
      frames_.push_back(frame);
    }
  }

  void plan_test(Split split) {
    const bool axis = split == Split::kTestAxis;
    Rng rng(options_.seed, axis ? 2 : 3);
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
        frame.plane =
            make_plane(options_.axis, held_out(lerp(kTestRange, step)), frame.camera, rng);
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

  // The height moved, if need be, so that its plane is none of training's.
  float held_out(float height) const {
    const Vec2 extent = matter_.extent(options_.axis);
    const float step = kHeldOut / static_cast<float>(std::max<size_t>(1, axis_offsets_.size()));
    const float least = step * (extent.y - extent.x);
    const auto taken = [&](float h) {
      const float offset = lerp(extent, h);
      return std::ranges::any_of(axis_offsets_,
                                 [&](float used) { return std::abs(used - offset) < least; });
    };
    while (taken(height)) {
      height += 0.7f * step;
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

}  // namespace clipgs
