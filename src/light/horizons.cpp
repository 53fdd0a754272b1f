#include "light/horizons.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/parallel.h"

namespace clipgs {
namespace {

// A node is in matter if what lies between it and the next would take half of the light.
constexpr float kMatterDepth = std::numbers::ln2_v<float>;

}  // namespace

const Horizons::Directions& Horizons::directions() {
  static const Directions directions = [] {
    Directions spread;
    for (int i = 0; i < kDirections; ++i) {
      spread[static_cast<size_t>(i)] = fibonacci_sphere(i, kDirections);
    }
    return spread;
  }();
  return directions;
}

Horizons::Horizons(const Occluders& occluders, int nodes)
    : direction_(occluders.direction), origin_(occluders.origin) {
  if (nodes < 2) {
    throw Error("light: a grid of {} nodes is too small; use 2 or more", nodes);
  }
  const Vec3 extent = Vec3(occluders.dims - 1) * occluders.spacing;
  spacing_ = std::max({extent.x, extent.y, extent.z}) / static_cast<float>(nodes - 1);
  for (int k = 0; k < 3; ++k) {
    constexpr float kSlack = 1e-3f;  // of a node's distance: rounding adds no node
    dims_[k] = static_cast<int>(std::ceil(extent[k] / spacing_ - kSlack)) + 1;
  }
  air_.resize(static_cast<size_t>(dims_.x) * dims_.y * dims_.z);
  distances_.assign(count() * kDirections, 0.0f);
  parallel_for(count(), 64, [&](size_t begin, size_t end) {
    for (size_t node = begin; node < end; ++node) {
      const Vec3 world = world_of(node_at(node));
      const float extinction = occluders.extinction_at(occluders.index_from_world(world));
      if (extinction * spacing_ >= kMatterDepth) {
        continue;
      }
      air_[node] = 1;
      for (size_t i = 0; i < kDirections; ++i) {
        distances_[node * kDirections + i] = horizon_distance(occluders, world, directions()[i]);
      }
    }
  });
}

IVec3 Horizons::node_at(size_t offset) const {
  const auto width = static_cast<size_t>(dims_.x);
  const auto height = static_cast<size_t>(dims_.y);
  return {offset % width, offset / width % height, offset / width / height};
}

IVec3 Horizons::nearest(const Vec3& world) const {
  const Vec3 index = ((world - origin_) * direction_) / spacing_;
  return glm::clamp(IVec3(glm::floor(index + 0.5f)), IVec3(0), dims_ - 1);
}

}  // namespace clipgs
