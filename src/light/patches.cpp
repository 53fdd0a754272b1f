#include "light/patches.h"

#include <algorithm>
#include <cmath>

namespace clipgs {
namespace {

int side_faced(const Vec3& n) {
  const Vec3 size = glm::abs(n);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  return 2 * axis + (n[axis] < 0 ? 1 : 0);
}

IVec3 cell_at(const PatchGrid& grid, const Vec3& world) {
  const IVec3 nearest(glm::floor(grid.index_from_world(world) + 0.5f));
  return glm::clamp(nearest, IVec3(0), grid.dims - 1);
}

/// Whether a point lies so far behind another that it is of another surface. `spacing`: of cells.
bool is_behind(const SurfacePoint& point, const SurfacePoint& other, float spacing) {
  constexpr float kApart = 0.3f;
  return glm::dot(point.position - other.position, other.normal) < -kApart * spacing;
}

}  // namespace

// What lies close below a surface and looks the same way, as skull does below skin, is left out of
// its patch: dark as it is, it would show through as blotches wherever cells happen to hold both.
Patches::Patches(const PatchGrid& grid, std::span<const SurfacePoint> scanned) : grid_(grid) {
  lookup_.assign(grid.cells() * kSides, kNone);
  const auto place_of = [&](const SurfacePoint& point) {
    const size_t cell = grid.offset(cell_at(grid, point.position));
    return cell * kSides + static_cast<size_t>(side_faced(point.normal * grid.direction));
  };
  const auto outward = [&](const SurfacePoint& point, size_t place) {
    const auto side = static_cast<int>(place % kSides);
    const float along = glm::dot(point.position, grid.direction[side / 2]);
    return side % 2 == 0 ? along : -along;
  };
  for (size_t i = 0; i < scanned.size(); ++i) {
    const size_t place = place_of(scanned[i]);
    std::int32_t& outermost = lookup_[place];
    if (outermost == kNone ||
        outward(scanned[i], place) > outward(scanned[static_cast<size_t>(outermost)], place)) {
      outermost = static_cast<std::int32_t>(i);
    }
  }
  std::vector<SurfacePoint> points;
  std::vector<std::uint32_t> places;
  for (const SurfacePoint& point : scanned) {
    const size_t place = place_of(point);
    if (!is_behind(point, scanned[static_cast<size_t>(lookup_[place])], grid.spacing)) {
      points.push_back(point);
      places.push_back(static_cast<std::uint32_t>(place));
    }
  }
  for (size_t place = 0; place < lookup_.size(); ++place) {
    if (lookup_[place] != kNone) {
      lookup_[place] = static_cast<std::int32_t>(places_.size());
      places_.push_back(static_cast<std::uint32_t>(place));
    }
  }
  patches_.assign(places_.size(), {Vec3(0), Vec3(0), Vec3(0)});
  std::vector<std::uint32_t> counts(places_.size(), 0);
  for (size_t i = 0; i < points.size(); ++i) {
    const auto patch = static_cast<size_t>(lookup_[places[i]]);
    patches_[patch].position += points[i].position;
    patches_[patch].normal += points[i].normal;
    patches_[patch].reflectance += points[i].reflectance;
    ++counts[patch];
  }
  for (size_t i = 0; i < patches_.size(); ++i) {
    const auto count = static_cast<float>(counts[i]);
    patches_[i].position /= count;
    patches_[i].normal = glm::normalize(patches_[i].normal);
    patches_[i].reflectance /= count;
  }
  // Sample k of a patch of n points is its point k·n / kSamples.
  samples_.resize(places_.size() * kSamples);
  std::vector<std::uint32_t> passed(places_.size(), 0);
  for (size_t i = 0; i < points.size(); ++i) {
    const auto patch = static_cast<size_t>(lookup_[places[i]]);
    const size_t count = counts[patch];
    const size_t at = passed[patch]++;
    for (size_t k = (at * kSamples + count - 1) / count; k * count < (at + 1) * kSamples; ++k) {
      samples_[patch * kSamples + k] = points[i];
    }
  }
}

std::int32_t Patches::met_by(const Vec3& world, const Vec3& direction) const {
  const IVec3 middle = cell_at(grid_, world);
  std::int32_t best = kNone;
  float least = 1e9f;
  for (int z = -1; z <= 1; ++z) {
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        const IVec3 cell = middle + IVec3(x, y, z);
        if (glm::any(glm::lessThan(cell, IVec3(0))) ||
            glm::any(glm::greaterThanEqual(cell, grid_.dims))) {
          continue;
        }
        for (int side = 0; side < kSides; ++side) {
          const std::int32_t patch = at(grid_.offset(cell), side);
          if (patch == kNone) {
            continue;
          }
          const SurfacePoint& point = patches_[static_cast<size_t>(patch)];
          const float facing = -glm::dot(point.normal, direction);
          if (facing <= 0) {
            continue;
          }
          const Vec3 apart = point.position - world;
          // Of those as near as each other the one that looks at where the ray comes from.
          const float distance =
              glm::dot(apart, apart) + (1 - facing) * 0.5f * grid_.spacing * grid_.spacing;
          if (distance < least) {
            least = distance;
            best = patch;
          }
        }
      }
    }
  }
  return best;
}

}  // namespace clipgs
