#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <span>

#include "cinema/choose_frames.h"
#include "cinema/held_out.h"
#include "cinema/make_dataset.h"
#include "cinema/picture.h"
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

// Axis planes of tests and of validation, at most: several views share one, so that the windows
// around them leave most of the extent to training. Half as many for validation, as there are
// frames: they come to lie in the middle between those of tests.
constexpr int kMostTestPlanes = 10;
constexpr int kMostValidationPlanes = 5;

// XClipGS's views of cuts: of three axes ten each, of five oblique planes three.
constexpr size_t kMostCutViews = 45;
constexpr int kObliqueCuts = 5;
constexpr float kDegree = 0.0174532925f;
constexpr float kFaceTilt = 10 * kDegree;    // of a view of a face, from straight
constexpr float kEdgeTilt = 1.5f * kDegree;  // of one of an edge, from along the plane
constexpr float kLeastAngle = 20 * kDegree;  // between oblique normals, and to axes

// Frames that are planned besides to choose from, as a multiple of the training frames.
constexpr int kOthers = 4;

enum Kind : size_t { kAxis, kOblique, kUncut, kKinds };

// Independent random streams of a plan.
enum Stream : std::uint64_t {
  kTraining = 1,
  kTestAxis,
  kTestOblique,
  kOtherTraining,
  kValidationAxis,
  kValidationOblique,
  kTestUncut,
  kTestClose,
  kValidationUncut,
  kValidationClose,
  kAims,
  kCutViews,
  kNear
};

// Of close-ups, in turn.
constexpr std::array<float, 3> kZooms{2, 3, 4};

bool is_close(Split split) {
  return split == Split::kTestClose || split == Split::kValidationClose;
}

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
      : matter_(matter),
        options_(options),
        held_out_(matter, options.axis, options.one_sided,
                  2 * static_cast<size_t>(options.test_frames + options.validation_frames) +
                      static_cast<size_t>(with_validation(options.uncut_frames) +
                                          with_validation(options.close_frames)) +
                      (options.cut_views ? kMostCutViews : 0)) {}

  std::vector<Frame> plan() {
    std::vector<Frame> others;
    if (options_.cut_views) {
      others = plan_cut_views(matter_, test_size(), options_.seed);
      held_out_.add(others);
    }
    const auto hold_out = [&](std::span<const Split> splits, int cut, int uncut, int close) {
      const size_t begin = others.size();
      plan_held_out(splits[0], cut, others);
      plan_held_out(splits[1], cut, others);
      plan_held_out(splits[2], uncut, others);
      plan_held_out(splits[3], close, others);
      held_out_.add(std::span(others).subspan(begin));
    };
    hold_out(kTestSplits, options_.test_frames, options_.uncut_frames, options_.close_frames);
    hold_out(kValidationSplits, options_.validation_frames, half(options_.uncut_frames),
             half(options_.close_frames));
    Rng rng(options_.seed, kTraining);
    std::vector<Frame> frames = training_frames(options_.train_frames, rng);
    std::ranges::move(others, std::back_inserter(frames));
    return frames;
  }

  /// The training frames of a plan and others, to choose as many of each kind and distance from.
  FramePool pool(const std::vector<Frame>& plan) const {
    FramePool pool;
    pool.quotas.assign(kKinds * kDistances.size(), 0);
    for (const Frame& frame : plan) {
      if (frame.split == Split::kTrain) {
        pool.frames.push_back(frame);
        ++pool.quotas[group_of(frame)];
      }
    }
    Rng rng(options_.seed, kOtherTraining);
    std::ranges::move(training_frames(kOthers * options_.train_frames, rng),
                      std::back_inserter(pool.frames));
    for (const Frame& frame : pool.frames) {
      pool.groups.push_back(group_of(frame));
    }
    return pool;
  }

 private:
  int test_size() const { return options_.test_size == 0 ? options_.size : options_.test_size; }
  static int half(int count) { return (count + 1) / 2; }
  static int with_validation(int count) { return count + half(count); }

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
    const std::vector<Vec3> directions = held_out_.spread_directions(count, rotation);
    // One axis plane in each of as many equal steps.
    std::vector<float> heights;
    heights.reserve(static_cast<size_t>(axis_count));
    for (int i = 0; i < axis_count; ++i) {
      heights.push_back((static_cast<float>(i) + rng.uniform()) / static_cast<float>(axis_count));
    }
    shuffle(heights, rng);
    for (int i = 0; i < count; ++i) {
      const float distance = kDistances[rng.below(kDistances.size())];
      Frame frame = make_frame(Split::kTrain, i, directions[static_cast<size_t>(i)], distance);
      if (kinds[static_cast<size_t>(i)] == kAxis) {
        const Vec2 range = options_.one_sided ? kTrainRangeBelow : kTrainRange;
        set_axis_plane(frame, held_out_.free_height(range, heights.back()), rng);
        heights.pop_back();
      } else if (kinds[static_cast<size_t>(i)] == kOblique) {
        frame.plane = make_oblique_plane(kTrainRange, frame.camera, rng);
      }
      frames.push_back(frame);
    }
    return frames;
  }

  static Stream stream_of(Split split) {
    switch (split) {
      case Split::kTestAxis:
        return kTestAxis;
      case Split::kTestOblique:
        return kTestOblique;
      case Split::kValidationAxis:
        return kValidationAxis;
      case Split::kValidationOblique:
        return kValidationOblique;
      case Split::kTestUncut:
        return kTestUncut;
      case Split::kTestClose:
        return kTestClose;
      case Split::kValidationUncut:
        return kValidationUncut;
      case Split::kValidationClose:
        return kValidationClose;
      case Split::kTestCutAxis:
      case Split::kTestCutOblique:
        return kCutViews;
      case Split::kTrain:
        break;
    }
    return kTraining;
  }

  static int most_planes(Split split) {
    return split == Split::kTestAxis ? kMostTestPlanes : kMostValidationPlanes;
  }

  /// Appends the frames of a test or validation split.
  void plan_held_out(Split split, int count, std::vector<Frame>& frames) const {
    const bool axis = split == Split::kTestAxis || split == Split::kValidationAxis;
    const bool uncut = split == Split::kTestUncut || split == Split::kValidationUncut;
    Rng rng(options_.seed, stream_of(split));
    std::vector<Vec3> directions = held_out_.spread_directions(count, random_rotation(rng));
    shuffle(directions, rng);
    const int planes = std::min(count, most_planes(split));
    for (int i = 0; i < count; ++i) {
      Frame frame = make_frame(split, i, directions[static_cast<size_t>(i)], 1.0f);
      if (axis) {
        const Vec2 range = options_.one_sided ? kTestRangeBelow : kTestRange;
        const float step = (static_cast<float>(i % planes) + 0.5f) / static_cast<float>(planes);
        set_axis_plane(frame, held_out_.free_height(range, step), rng);
      } else if (!uncut && !(is_close(split) && i % 2 == 1)) {
        frame.plane = make_oblique_plane(kTestRange, frame.camera, rng);
      }
      if (is_close(split)) {
        const float zoom = kZooms[static_cast<size_t>(i) % kZooms.size()];
        frame.camera.fx *= zoom;
        frame.camera.fy *= zoom;
      }
      const std::string file = fmt::format("{}_{:04}.png", split_name(split), i);
      frame.depth_file = "depth/" + file;
      if (frame.plane) {
        frame.uncut_file = "uncut/" + file;
        frame.uncut_depth_file = "uncut_depth/" + file;
      }
      frames.push_back(frame);
    }
  }

  Frame make_frame(Split split, int number, const Vec3& direction, float distance) const {
    Frame frame;
    const Sphere& sphere = matter_.sphere;
    const int size = split == Split::kTrain ? options_.size : test_size();
    frame.camera = look_at(sphere.center + framing_distance(sphere.radius) * distance * direction,
                           sphere.center, Vec3(0, 0, 1), size, size);
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
                             frame.camera.width, frame.camera.height);
    }
    frame.plane = plane;
  }

  // A plane of any direction, far enough from those that are held out.
  Plane make_oblique_plane(const Vec2& range, const Camera& camera, Rng& rng) const {
    for (;;) {
      const Vec3 normal = random_direction(rng);
      const Plane plane = make_plane(normal, lerp(range, rng.uniform()), camera, rng);
      if (!held_out_.near(plane)) {
        return plane;
      }
    }
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

  const VisibleMatter& matter_;
  const DatasetOptions& options_;
  HeldOut held_out_;
};

/// Views of cuts, numbered by their splits.
class CutViews {
 public:
  CutViews(const Sphere& sphere, int size) : sphere_(sphere), size_(size) {}

  /// `faces` views from the removed side, the first straight unless `tilted`, and `edges` along the
  /// plane.
  void add(Split split, const Vec3& normal, int faces, bool tilted, int edges, float turn) {
    const Plane plane{normal, glm::dot(normal, sphere_.center)};
    Vec3 a;
    Vec3 b;
    orthonormal_basis(normal, a, b);
    const auto around = [&](int i, int count) {
      const float angle = turn + 6.2831853f * static_cast<float>(i) / static_cast<float>(count);
      return std::cos(angle) * a + std::sin(angle) * b;
    };
    for (int i = 0; i < faces; ++i) {
      const float tilt = i == 0 && !tilted ? 0 : kFaceTilt;
      add_view(split, plane, -std::cos(tilt) * normal + std::sin(tilt) * around(i, faces));
    }
    for (int i = 0; i < edges; ++i) {
      add_view(split, plane, std::cos(kEdgeTilt) * around(i, edges) + std::sin(kEdgeTilt) * normal);
    }
  }

  std::vector<Frame> frames;

 private:
  void add_view(Split split, const Plane& plane, const Vec3& direction) {
    Frame frame;
    frame.camera = frame_sphere(sphere_, direction, 1, size_, size_);
    frame.plane = plane;
    frame.split = split;
    const auto number = std::ranges::count(frames, split, &Frame::split);
    const std::string file = fmt::format("{}_{:04}.png", split_name(split), number);
    frame.file = "images/" + file;
    frame.depth_file = "depth/" + file;
    frame.uncut_file = "uncut/" + file;
    frame.uncut_depth_file = "uncut_depth/" + file;
    frames.push_back(frame);
  }

  const Sphere& sphere_;
  int size_;
};

/// Unit normals at least kLeastAngle from the axes and from each other.
std::vector<Vec3> oblique_normals(Rng& rng) {
  std::vector<Vec3> taken = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  while (taken.size() < 3 + kObliqueCuts) {
    const Vec3 normal = random_direction(rng);
    const bool is_free = std::ranges::all_of(taken, [&](const Vec3& other) {
      return std::abs(glm::dot(normal, other)) < std::cos(kLeastAngle);
    });
    if (is_free) {
      taken.push_back(normal);
    }
  }
  return {taken.begin() + 3, taken.end()};
}

}  // namespace

std::vector<Frame> plan_cut_views(const VisibleMatter& matter, int size, std::uint64_t seed) {
  Rng rng(seed, kCutViews);
  CutViews views(matter.sphere, size);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 normal(0);
    normal[axis] = 1;
    views.add(Split::kTestCutAxis, normal, 5, false, 5, 0);
  }
  for (const Vec3& normal : oblique_normals(rng)) {
    views.add(Split::kTestCutOblique, normal, 1, true, 2, 6.2831853f * rng.uniform());
  }
  return std::move(views.frames);
}

std::vector<Frame> plan_frames(const VisibleMatter& matter, const DatasetOptions& options) {
  return Planner(matter, options).plan();
}

namespace {

/// Where a camera's rays meet matter first: on the plane if any of them does.
std::vector<Vec3> seen_places(const CinemaScene& scene, const Camera& camera,
                              const std::optional<Plane>& plane) {
  constexpr float kOnPlane = 1.5f;  // voxels
  const Image depth = render_depth(scene, camera, plane);
  const float tolerance = kOnPlane * mean_spacing(scene.volume().spacing);
  std::vector<Vec3> all;
  std::vector<Vec3> of_face;
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) {
      const float hit = *depth.at(x, y);
      if (hit <= 0) {
        continue;
      }
      const Vec3 ray =
          camera.ray_direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      all.push_back(camera.position + hit * ray);
      if (plane && std::abs(plane->signed_distance(all.back())) < tolerance) {
        of_face.push_back(all.back());
      }
    }
  }
  return of_face.empty() ? all : of_face;
}

}  // namespace

void aim_close_ups(const CinemaScene& scene, std::uint64_t seed, std::vector<Frame>& frames) {
  constexpr int kSide = 64;  // px, of the picture that places are chosen in
  for (size_t i = 0; i < frames.size(); ++i) {
    Frame& frame = frames[i];
    if (!is_close(frame.split)) {
      continue;
    }
    const Camera planned = frame.camera;
    const Camera whole = look_at(planned.position, planned.position + planned.forward(),
                                 Vec3(0, 0, 1), kSide, kSide);
    const std::vector<Vec3> places = seen_places(scene, whole, frame.plane);
    if (places.empty()) {
      continue;  // the plane left nothing that this camera sees
    }
    Rng rng(seed, Rng::mix(i) ^ kAims);
    frame.camera =
        look_at(planned.position, places[rng.below(static_cast<std::uint32_t>(places.size()))],
                Vec3(0, 0, 1), planned.width, planned.height);
    frame.camera.fx = planned.fx;
    frame.camera.fy = planned.fy;
  }
}

void bring_near(float share, std::uint64_t seed, std::vector<Frame>& frames) {
  Rng rng(seed, kNear);
  for (Frame& frame : frames) {
    if (frame.split != Split::kTrain || rng.uniform() >= share) {
      continue;
    }
    Camera& camera = frame.camera;
    camera.fx *= 2;
    camera.fy *= 2;
    camera.cx = 2 * camera.cx - rng.uniform() * static_cast<float>(camera.width);
    camera.cy = 2 * camera.cy - rng.uniform() * static_cast<float>(camera.height);
  }
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
