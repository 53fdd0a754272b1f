#include "section/section_light.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "section/material_table.h"

namespace clipgs {
namespace {

constexpr int kOccluders = 224;   // samples along the longest side, at most
constexpr int kCells = 48;        // of patches, along the longest side, at most …
constexpr float kCellVoxels = 3;  // … and no smaller than this, in voxels of the traced volume:
                                  // splats do not lie on a surface to less

/// Code of a voxel → how much of the light a mean voxel of the traced volume takes.
std::array<float, ValueCurve::kCodes> coverages(const Section& section) {
  std::array<float, ValueCurve::kCodes> table;
  const float length = mean_spacing(section.source_spacing);
  for (size_t code = 0; code < table.size(); ++code) {
    table[code] = 1 - std::exp(-section.materials[code].extinction * length);
  }
  return table;
}

float longest(const Section& section) {
  const Vec3 extent = Vec3(section.dims - 1) * section.spacing;
  return std::max({extent.x, extent.y, extent.z});
}

/// Side of a patch's cell, mm.
float cell_size(const Section& section) {
  return std::max(longest(section) / (kCells - 1),
                  kCellVoxels * mean_spacing(section.source_spacing));
}

IVec3 samples_of(const Section& section, float spacing) {
  constexpr float kSlack = 1e-3f;  // of a sample's distance: rounding adds none
  return IVec3(glm::ceil(Vec3(section.dims - 1) * section.spacing / spacing - kSlack)) + 1;
}

/// What a ray sees that meets matter straight at `at` (index), where air lies along `normal` and
/// values are as steep as `steepness` (per mm).
Vec3 reflectance_at(const Section& section, const MaterialTable& materials, const Vec3& at,
                    const Vec3& normal, float steepness) {
  const float voxel = mean_spacing(section.source_spacing);
  const float length = 0.25f * voxel;
  const Vec3 step = (-normal * section.direction) / section.spacing;
  constexpr int kSteps = 12;  // from a voxel before the surface to two below it
  const float share = section.steep ? section.steep->share(steepness) : 0;
  Vec3 sum(0);
  float transmittance = 1;
  for (int i = 0; i < kSteps && transmittance > 0.02f; ++i) {
    const float t = static_cast<float>(i) * length - voxel;
    const Vec3 sampled = section.sample(at + t * step);
    const FaceMaterial& material = materials.of_value(section.value(sampled));
    const float alpha = 1 - std::exp(-material.extinction * length);
    if (alpha > 0) {
      const Vec3 tint = section.channels == 3 ? photo_albedo(sampled) : Vec3(1);
      const Vec3 reflectance = glm::mix(material.surface, material.boundary, share);
      sum += transmittance * alpha * reflectance * tint;
      transmittance *= 1 - alpha;
    }
  }
  return sum / std::max(1 - transmittance, 1e-3f);
}

/// What one slice adds to a scan.
struct SliceScan {
  std::vector<SurfacePoint> points;
  size_t matter = 0;  // voxels
  size_t translucent = 0;
};

/// Whether any code between two has matter: interpolation passes through all of them.
class MatterBetween {
 public:
  explicit MatterBetween(const Section& section) {
    for (size_t code = 0; code < ValueCurve::kCodes; ++code) {
      before_[code + 1] = before_[code] + (section.materials[code].extinction > 0 ? 1 : 0);
    }
  }
  bool operator()(int low, int high) const {
    return before_[static_cast<size_t>(high) + 1] > before_[static_cast<size_t>(low)];
  }

 private:
  std::array<int, ValueCurve::kCodes + 1> before_{};
};

}  // namespace

EmptySpace find_empty_space(const Section& section) {
  constexpr float kHalfInside = 0.5f * Section::kFirstInside;  // lossy coding moves codes a little
  const MatterBetween has_matter(section);
  // Of the first and the last side along each axis: whether the volume ends there in matter. Where
  // it does not, air around the body begins at the latest.
  std::array<std::array<bool, 2>, 3> ends{};
  for (const Plane& end : section.ends()) {
    for (int axis = 0; axis < 3; ++axis) {
      const float along = glm::dot(end.normal, section.direction[axis]);
      ends[static_cast<size_t>(axis)][0] |= along > 0.5f;
      ends[static_cast<size_t>(axis)][1] |= along < -0.5f;
    }
  }
  const auto is_at_air = [&](const IVec3& low, const IVec3& high) {
    bool any = false;
    for (int axis = 0; axis < 3; ++axis) {
      const auto& [first, last] = ends[static_cast<size_t>(axis)];
      any |= low[axis] == 0 && !first;
      any |= high[axis] == section.dims[axis] - 1 && !last;
    }
    return any;
  };
  return {section.dims, [&](const IVec3& low, const IVec3& high) {
            float least = 255;
            float most = 0;
            for (int z = low.z; z <= high.z; ++z) {
              for (int y = low.y; y <= high.y; ++y) {
                for (int x = low.x; x <= high.x; ++x) {
                  const float code = section.code_at({x, y, z});
                  least = std::min(least, code);
                  most = std::max(most, code);
                }
              }
            }
            return EmptySpace::Block{
                has_matter(static_cast<int>(least), static_cast<int>(std::ceil(most))),
                least < kHalfInside || is_at_air(low, high)};
          }};
}

Occluders make_occluders(const Section& section, int size) {
  Occluders occluders;
  const Vec3 finest = section.spacing;
  occluders.spacing = std::max(std::min({finest.x, finest.y, finest.z}),
                               longest(section) / static_cast<float>(size - 1));
  occluders.dims = samples_of(section, occluders.spacing);
  occluders.direction = section.direction;
  occluders.origin = section.origin;
  const std::array<float, ValueCurve::kCodes> table = coverages(section);
  const size_t count = static_cast<size_t>(occluders.dims.x) * occluders.dims.y * occluders.dims.z;
  occluders.coverage.assign(count, 0);
  const Vec3 scale = section.spacing / occluders.spacing;
  // The voxels whose centres are nearest to a sample; where there are none, the one nearest to it.
  const auto range = [&](int axis, int sample) {
    const float s = scale[axis];
    const int last = section.dims[axis] - 1;
    const int low = static_cast<int>(std::ceil((static_cast<float>(sample) - 0.5f) / s));
    const int high = static_cast<int>(std::ceil((static_cast<float>(sample) + 0.5f) / s)) - 1;
    const int nearest =
        std::min(last, static_cast<int>(std::lround(static_cast<float>(sample) / s)));
    return low > high ? std::pair(nearest, nearest)
                      : std::pair(std::clamp(low, 0, last), std::clamp(high, 0, last));
  };
  parallel_for(static_cast<size_t>(occluders.dims.z), 1, [&](size_t z, size_t) {
    const auto [z0, z1] = range(2, static_cast<int>(z));
    for (int y = 0; y < occluders.dims.y; ++y) {
      const auto [y0, y1] = range(1, y);
      for (int x = 0; x < occluders.dims.x; ++x) {
        const auto [x0, x1] = range(0, x);
        float sum = 0;
        for (int k = z0; k <= z1; ++k) {
          for (int j = y0; j <= y1; ++j) {
            for (int i = x0; i <= x1; ++i) {
              sum += table[static_cast<size_t>(section.code_at({i, j, k}))];
            }
          }
        }
        const int voxels = (z1 - z0 + 1) * (y1 - y0 + 1) * (x1 - x0 + 1);
        occluders.coverage[occluders.offset({x, y, static_cast<int>(z)})] =
            static_cast<std::uint8_t>(std::lround(255 * sum / static_cast<float>(voxels)));
      }
    }
  });
  return occluders;
}

SurfaceScan scan_surfaces(const Section& section, bool all) {
  constexpr float kLeastMatter = 0.01f;
  constexpr float kHalf = 0.5f;
  const std::array<float, ValueCurve::kCodes> table = coverages(section);
  const MaterialTable materials(section);
  // About as many points on each patch, however fine the voxels are.
  const int stride =
      all ? 1
          : std::max(1, static_cast<int>(cell_size(section) / 4 / mean_spacing(section.spacing)));
  const auto coverage = [&](const IVec3& voxel) {
    return table[static_cast<size_t>(section.code_at(voxel))];
  };
  std::vector<SliceScan> slices(static_cast<size_t>(section.dims.z));
  parallel_for(slices.size(), 1, [&](size_t z, size_t) {
    SliceScan& slice = slices[z];
    for (int y = 0; y < section.dims.y; ++y) {
      for (int x = (y + static_cast<int>(z)) % stride; x < section.dims.x; x += stride) {
        const IVec3 voxel(x, y, z);
        const float here = coverage(voxel);
        slice.matter += here > kLeastMatter ? 1 : 0;
        slice.translucent += here > kLeastMatter && here < kHalf ? 1 : 0;
        for (int axis = 0; axis < 3; ++axis) {
          IVec3 next = voxel;
          if (++next[axis] >= section.dims[axis] || (coverage(next) < kHalf) == (here < kHalf)) {
            continue;
          }
          const Vec3 at = 0.5f * Vec3(voxel + next);
          const Vec3 outward = (here < kHalf ? -1.0f : 1.0f) * section.direction[axis];
          Vec3 normal = -gradient_at(section, at);
          const float steepness = glm::length(normal);
          const float along = glm::dot(normal, outward);
          // Where values say otherwise than matter does (thin walls), the voxels' own side is
          // right.
          normal = along > 1e-3f * steepness ? glm::normalize(normal) : outward;
          slice.points.push_back({section.world_from_index(at), normal,
                                  reflectance_at(section, materials, at, normal, steepness)});
        }
      }
    }
  });
  SurfaceScan scan;
  size_t matter = 0;
  size_t translucent = 0;
  for (const SliceScan& slice : slices) {
    scan.points.insert(scan.points.end(), slice.points.begin(), slice.points.end());
    matter += slice.matter;
    translucent += slice.translucent;
  }
  scan.translucent =
      static_cast<float>(translucent) / static_cast<float>(std::max<size_t>(1, matter));
  return scan;
}

CutLight make_cut_light(const Section& section, std::span<const SurfacePoint> points,
                        const LightRig& rig) {
  PatchGrid grid;
  grid.spacing = cell_size(section);
  grid.dims = samples_of(section, grid.spacing);
  grid.direction = section.direction;
  grid.origin = section.origin;
  return {make_occluders(section, kOccluders), Patches(grid, points), rig,
          mean_spacing(section.source_spacing)};
}

}  // namespace clipgs
