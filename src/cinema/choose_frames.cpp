#include "cinema/choose_frames.h"

#include <algorithm>
#include <numbers>
#include <queue>

#include "core/parallel.h"
#include "core/ray_span.h"

namespace clipgs {
namespace {

constexpr int kPixels = 24;     // a side of the pictures by which frames are judged
constexpr int kCells = 32;      // across the sphere: of surfaces …
constexpr int kFine = 96;       // … and of the matter that these pictures show
constexpr int kSides = 6;       // that a surface is looked at from
constexpr float kBelow = 0.1f;  // of the sphere's radius: matter this near to a face is lit by it
// A section draws the faces: splats are left with their rims.
constexpr float kFaceWeight = 0.1f;
// Share of a picture that shows a cell once. Pictures count by shares, or large ones, which cost as
// many more paths, would be preferred.
constexpr float kShareOfCell = 1.0f / (0.5f * kCells * kCells);

enum Band : std::uint32_t { kFace, kBelowFace, kFarFromFace, kBands };

constexpr size_t kSurfaces = size_t{kCells} * kCells * kCells * kSides * kBands;

/// A surface that a frame shows.
struct Seen {
  std::uint32_t surface;
  float share;  // of the picture's pixels with matter
};

/// Index of the cell of a cube of `cells`³ that `point`, in [0, 1]³, lies in.
size_t cell_of(const Vec3& point, int cells) {
  const IVec3 c = glm::clamp(IVec3(point * static_cast<float>(cells)), 0, cells - 1);
  return (static_cast<size_t>(c.z) * static_cast<size_t>(cells) + static_cast<size_t>(c.y)) *
             static_cast<size_t>(cells) +
         static_cast<size_t>(c.x);
}

std::uint32_t side_of(const Vec3& direction) {
  const Vec3 a = glm::abs(direction);
  const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
  return static_cast<std::uint32_t>(2 * axis + (direction[axis] < 0 ? 1 : 0));
}

/// Mean extinctions of coarse cells of the cube around the sphere: a picture of them takes a
/// hundredth of the time that one of the volume takes.
class CoarseMatter {
 public:
  CoarseMatter(const CinemaScene& scene, const Sphere& sphere)
      : sphere_(sphere), extinction_(size_t{kFine} * kFine * kFine) {
    parallel_for(kFine, 1, [&](size_t z, size_t) {
      for (int y = 0; y < kFine; ++y) {
        for (int x = 0; x < kFine; ++x) {
          const Vec3 corner(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
          extinction_[cell_of((corner + 0.5f) / static_cast<float>(kFine), kFine)] =
              mean_extinction(scene, corner);
        }
      }
    });
  }

  /// The surfaces that a frame shows.
  std::vector<Seen> look(const Frame& frame) const {
    const float pixel = static_cast<float>(frame.camera.width) / kPixels;
    std::vector<std::uint32_t> hits;
    for (int y = 0; y < kPixels; ++y) {
      for (int x = 0; x < kPixels; ++x) {
        const Vec3 direction = frame.camera.ray_direction((static_cast<float>(x) + 0.5f) * pixel,
                                                          (static_cast<float>(y) + 0.5f) * pixel);
        add_hit(frame, direction, hits);
      }
    }
    std::ranges::sort(hits);
    std::vector<Seen> seen;
    for (const std::uint32_t surface : hits) {
      if (seen.empty() || seen.back().surface != surface) {
        seen.push_back({surface, 0});
      }
      seen.back().share += 1.0f / static_cast<float>(hits.size());
    }
    return seen;
  }

 private:
  float cell_size() const { return 2 * sphere_.radius / kFine; }
  Vec3 corner() const { return sphere_.center - sphere_.radius; }

  float mean_extinction(const CinemaScene& scene, const Vec3& cell) const {
    float sum = 0;
    for (int i = 0; i < 8; ++i) {
      const Vec3 within(0.25f + 0.5f * static_cast<float>(i & 1),
                        0.25f + 0.5f * static_cast<float>(i >> 1 & 1),
                        0.25f + 0.5f * static_cast<float>(i >> 2));
      const Vec3 voxel = scene.voxel_from_world(corner() + (cell + within) * cell_size());
      const Box& occupied = scene.majorants().occupied();
      if (glm::all(glm::greaterThanEqual(voxel, occupied.min)) &&
          glm::all(glm::lessThanEqual(voxel, occupied.max))) {
        sum += scene.extinction(voxel);
      }
    }
    return sum / 8;
  }

  /// Appends the surface that a ray from the camera first meets, if any: where half of the light is
  /// lost.
  void add_hit(const Frame& frame, const Vec3& direction, std::vector<std::uint32_t>& hits) const {
    RaySpan<float> span;
    const Vec3 origin = frame.camera.position - corner();
    for (int k = 0; k < 3; ++k) {
      span.keep(origin[k], direction[k]);
      span.keep(2 * sphere_.radius - origin[k], -direction[k]);
    }
    if (frame.plane) {
      span.keep(frame.plane->signed_distance(frame.camera.position),
                glm::dot(frame.plane->normal, direction));
    }
    const float step = cell_size();
    const int steps = static_cast<int>((span.leave - span.enter) / step);
    constexpr float kHalf = std::numbers::ln2_v<float>;  // of the light is gone
    float depth = 0;
    for (int i = 0; i < steps; ++i) {
      const float t = span.enter + (static_cast<float>(i) + 0.5f) * step;
      const Vec3 unit = (origin + t * direction) / (2 * sphere_.radius);
      depth += step * extinction_[cell_of(unit, kFine)];
      if (depth > kHalf) {
        const size_t place = cell_of(unit, kCells) * kSides + side_of(direction);
        hits.push_back(static_cast<std::uint32_t>(
            place * kBands + band_of(frame, frame.camera.position + t * direction)));
        return;
      }
    }
  }

  Band band_of(const Frame& frame, const Vec3& point) const {
    const float below = frame.plane ? frame.plane->signed_distance(point) : sphere_.radius;
    return below < cell_size()               ? kFace
           : below < kBelow * sphere_.radius ? kBelowFace
                                             : kFarFromFace;
  }

  Sphere sphere_;
  std::vector<float> extinction_;  // 1/mm
};

/// What the frames chosen so far leave to learn.
class Unseen {
 public:
  explicit Unseen(const std::vector<std::vector<Seen>>& views)
      : importance_(kSurfaces, 0), times_(kSurfaces, 0) {
    for (const std::vector<Seen>& view : views) {
      for (const Seen& seen : view) {
        const float weight = seen.surface % kBands == kFace ? kFaceWeight : 1.0f;
        importance_[seen.surface] += weight * seen.share;
      }
    }
  }

  /// By how much Σ p/(1 + n) falls with one more view.
  double gain(const std::vector<Seen>& view) const {
    double sum = 0;
    for (const Seen& seen : view) {
      const float before = 1 + times_[seen.surface];
      const float times = seen.share / kShareOfCell;
      sum += importance_[seen.surface] * times / (before * (before + times));
    }
    return sum;
  }

  void take(const std::vector<Seen>& view) {
    for (const Seen& seen : view) {
      times_[seen.surface] += seen.share / kShareOfCell;
    }
  }

 private:
  std::vector<float> importance_;  // p of each surface
  std::vector<float> times_;       // n of each surface
};

struct Candidate {
  double gain;
  size_t index;
  bool operator<(const Candidate& other) const {
    return gain != other.gain ? gain < other.gain : index > other.index;
  }
};

}  // namespace

std::vector<size_t> choose_frames(const CinemaScene& scene, const Sphere& sphere,
                                  const FramePool& pool) {
  const CoarseMatter matter(scene, sphere);
  std::vector<std::vector<Seen>> views(pool.frames.size());
  parallel_for(views.size(), 8, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      views[i] = matter.look(pool.frames[i]);
    }
  });
  Unseen unseen(views);
  std::priority_queue<Candidate> queue;
  for (size_t i = 0; i < views.size(); ++i) {
    queue.push({unseen.gain(views[i]), i});
  }
  // Gains only ever fall: one that is the largest when brought up to date is the largest of all.
  std::vector<size_t> left = pool.quotas;
  std::vector<size_t> chosen;
  while (!queue.empty()) {
    Candidate best = queue.top();
    queue.pop();
    if (left[pool.groups[best.index]] == 0) {
      continue;
    }
    best.gain = unseen.gain(views[best.index]);
    if (!queue.empty() && best < queue.top()) {
      queue.push(best);
      continue;
    }
    unseen.take(views[best.index]);
    chosen.push_back(best.index);
    --left[pool.groups[best.index]];
  }
  std::ranges::sort(chosen);
  return chosen;
}

}  // namespace clipgs
