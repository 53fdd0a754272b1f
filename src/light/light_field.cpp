#include "light/light_field.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace clipgs {
namespace {

constexpr auto kDirections = static_cast<size_t>(Horizons::kDirections);
constexpr float kPart = 1.0f / Horizons::kDirections;  // of the sphere
constexpr size_t kNodesATurn = 256;

// A key light is seen by the directions around it, weighted by exp(kKeyLobe·(cos − 1)): about as
// wide as directions are apart.
constexpr float kKeyLobe = 30;

// How far before a wall its light is looked up, in distances of nodes.
constexpr float kBeforeWall = 0.75f;
// How far from a surface the light that falls on it is looked up, in distances of nodes.
constexpr float kLift = 0.75f;

Vec3 sky_radiance(const LightRig& rig, const Vec3& direction) {
  const float up = direction.z;  // the sky's gradient runs along S
  return up >= 0 ? glm::mix(rig.sky_horizon, rig.sky_top, up)
                 : glm::mix(rig.sky_horizon, rig.sky_bottom, -up);
}

/// Weights of the directions around a key light; they add up to 1.
std::array<float, kDirections> key_lobe(const KeyLight& key) {
  std::array<float, kDirections> lobe{};
  float sum = 0;
  for (size_t i = 0; i < kDirections; ++i) {
    lobe[i] = std::exp(kKeyLobe * (glm::dot(Horizons::directions()[i], key.direction) - 1));
    sum += lobe[i];
  }
  for (float& weight : lobe) {
    weight /= sum;
  }
  return lobe;
}

bool near_kept(const Cut& cut, const Vec3& world, float reach) {
  return std::ranges::all_of(
      cut.planes(), [&](const Plane& plane) { return plane.signed_distance(world) > -reach; });
}

}  // namespace

void Radiance::add(const Vec3& power, const Vec3& direction) {
  mean += power;
  for (size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<glm::length_t>(k);
    const Vec3 part = direction[axis] * power;
    first[k] += part;
    second[k] += direction[axis] * part;
    second[3 + k] += direction[(axis + 1) % 3] * part;
  }
}

Vec3 Radiance::reflected(const Vec3& normal) const {
  // The cosine's weights of degrees 0, 1 and 2 are 1, 2/3 and 1/4, times 2l + 1 and Legendre's
  // polynomials of n·ω.
  Vec3 sum = 0.375f * mean;
  for (size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<glm::length_t>(k);
    const float along = normal[axis];
    sum += 2.0f * along * first[k] +
           1.875f *
               (along * along * second[k] + 2.0f * along * normal[(axis + 1) % 3] * second[3 + k]);
  }
  return glm::max(Vec3(0), sum);
}

LightField::LightField(const Horizons& horizons, const Occluders& occluders, const LightRig& rig,
                       const Cut& cut, const LightFieldOptions& options)
    : horizons_(horizons) {
  const Field direct = direct_light(rig, cut);
  field_ = direct;
  if (options.bounces > 0) {
    find_walls(occluders);
  }
  for (int i = 0; i < options.bounces; ++i) {
    Field next = direct;
    add_bounce(field_, next);
    field_ = std::move(next);
  }
}

LightField::Field LightField::direct_light(const LightRig& rig, const Cut& cut) {
  std::array<Vec3, kDirections> sky;
  for (size_t i = 0; i < kDirections; ++i) {
    sky[i] = sky_radiance(rig, Horizons::directions()[i]);
  }
  std::vector<std::array<float, kDirections>> lobes;
  lobes.reserve(rig.keys.size());
  for (const KeyLight& key : rig.keys) {
    lobes.push_back(key_lobe(key));
  }
  Field field(horizons_.count());
  visible_.assign(horizons_.count() * kDirections, 0);
  const auto light = [&](size_t node) {
    const Vec3 world = horizons_.world_of(horizons_.node_at(node));
    // Nodes just beyond a plane light the points before it.
    if (!horizons_.in_air(node) || !near_kept(cut, world, horizons_.spacing())) {
      return;
    }
    for (size_t i = 0; i < kDirections; ++i) {
      const Vec3& direction = Horizons::directions()[i];
      if (horizons_.distance(node, static_cast<int>(i)) >= exit_distance(cut, world, direction)) {
        visible_[node * kDirections + i] = 1;
        field[node].add(kPart * sky[i], direction);
      }
    }
    for (size_t k = 0; k < lobes.size(); ++k) {
      float seen = 0;
      for (size_t i = 0; i < kDirections; ++i) {
        seen += visible(node, i) ? lobes[k][i] : 0;
      }
      // What faces it radiates `radiance`: its irradiance is π times that.
      field[node].add(0.25f * seen * rig.keys[k].radiance, rig.keys[k].direction);
    }
  };
  parallel_for(field.size(), kNodesATurn, [&](size_t begin, size_t end) {
    for (size_t node = begin; node < end; ++node) {
      light(node);
    }
  });
  return field;
}

void LightField::find_walls(const Occluders& occluders) {
  for (size_t node = 0; node < horizons_.count(); ++node) {
    first_wall_.push_back(walls_.size());
    if (!horizons_.in_air(node)) {
      continue;
    }
    const Vec3 world = horizons_.world_of(horizons_.node_at(node));
    for (size_t i = 0; i < kDirections; ++i) {
      const float distance = horizons_.distance(node, static_cast<int>(i));
      if (visible(node, i) || distance >= kNever) {
        continue;
      }
      const Vec3& direction = Horizons::directions()[i];
      const float before = std::max(0.0f, distance - kBeforeWall * horizons_.spacing());
      const size_t next = horizons_.offset(horizons_.nearest(world + before * direction));
      walls_.push_back({horizons_.in_air(next) ? next : node,
                        occluders.albedo_at(world + distance * direction), i});
    }
  }
  first_wall_.push_back(walls_.size());
}

void LightField::add_bounce(const Field& light, Field& sum) const {
  parallel_for(sum.size(), kNodesATurn, [&](size_t begin, size_t end) {
    for (size_t node = begin; node < end; ++node) {
      for (size_t i = first_wall_[node]; i < first_wall_[node + 1]; ++i) {
        const Wall& wall = walls_[i];
        const Vec3& direction = Horizons::directions()[wall.direction];
        sum[node].add(kPart * wall.albedo * light[wall.before].reflected(-direction), direction);
      }
    }
  });
}

Vec3 LightField::reflected(const Vec3& world, const Vec3& normal) const {
  Vec3 sum(0);
  horizons_.interpolate(
      world + kLift * horizons_.spacing() * normal,
      [&](size_t node, float weight) { sum += weight * field_[node].reflected(normal); });
  return sum;
}

}  // namespace clipgs
