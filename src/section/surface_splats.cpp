#include "section/surface_splats.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <vector>

#include "core/parallel.h"
#include "section/display_curve.h"
#include "section/face_light.h"
#include "section/material_table.h"
#include "splat/disc.h"

namespace clipgs {
namespace {

// Deviations of a disc, in sides of a cell: neighbours overlap so far that no gap is left between
// them, and no farther, for a picture of them is as blurred as they are wide.
constexpr float kWide = 0.65f;
constexpr float kThick = 0.15f;
constexpr float kOpacity = 0.95f;
// Where points lie on the surface itself, not between voxels: thinner discs, no smaller than so
// many voxels of the section.
constexpr float kThin = 0.05f;
constexpr float kFinest = 1.2f;

/// The grid of light, or a finer one with about `count` patches for `lit` of its own.
PatchGrid grid_of(const PatchGrid& light, size_t lit, size_t count) {
  const double finer = std::sqrt(static_cast<double>(count) / static_cast<double>(lit));
  PatchGrid grid = light;
  grid.spacing = light.spacing / static_cast<float>(finer);
  grid.dims = IVec3(glm::ceil(Vec3(light.dims - 1) * light.spacing / grid.spacing)) + 1;
  return grid;
}

/// Of a scan what a ray meets: threads that it passes by have no colour.
std::vector<SurfacePoint> colored(const SurfaceScan& scan) {
  constexpr float kBlack = 0.01f;
  std::vector<SurfacePoint> points;
  std::ranges::copy_if(scan.points, std::back_inserter(points), [](const SurfacePoint& point) {
    return std::max({point.reflectance.r, point.reflectance.g, point.reflectance.b}) > kBlack;
  });
  return points;
}

/// Points of a scan, which lie halfway between voxels, where rays that come straight meet a wall.
std::vector<SurfacePoint> on_walls(const Section& section, const Openings& openings,
                                   std::vector<SurfacePoint> points) {
  const float reach = 1.5f * mean_spacing(section.spacing);
  constexpr size_t kGrain = 4096;
  parallel_for(points.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      SurfacePoint& point = points[i];
      const Vec3 eye = point.position + reach * point.normal;
      const std::optional<Wall> wall =
          openings.first_wall(section, eye, -point.normal, 0, 2 * reach);
      // In a narrow gap the eye is in other matter.
      if (wall && glm::distance(wall->position, eye) > 0.25f * reach) {
        point = {wall->position, wall->normal, wall->reflectance};
      }
    }
  });
  return points;
}

bool is_kept(const Vec3& position, const Cut& cut) {
  return std::ranges::all_of(
      cut.planes(), [&](const Plane& plane) { return plane.signed_distance(position) > 0; });
}

/// What discs show: places, and what the eye sees there, linear RGB before exposure.
struct Shown {
  std::vector<SurfacePoint> points;
  std::vector<Vec3> radiance;

  void add(const SurfacePoint& point, const Vec3& white) {
    points.push_back(point);
    radiance.push_back(point.reflectance * white);
  }

  void add(const Shown& others) {
    points.insert(points.end(), others.points.begin(), others.points.end());
    radiance.insert(radiance.end(), others.radiance.begin(), others.radiance.end());
  }
};

void add_lit_surfaces(const Patches& patches, const Openings& openings, Shown& shown) {
  for (const SurfacePoint& point : patches.all()) {
    const Vec3 white =
        light_at(openings.light().patches(), openings.own_light(), point.position, point.normal);
    if (Openings::is_lit(white)) {
      shown.add(point, white);
    }
  }
}

/// Where matter ends because the volume does, which scan_surfaces() does not count: in the light of
/// faces.
void add_ends(const Section& section, const PatchGrid& grid, Shown& shown) {
  constexpr float kHalf = 0.5f;
  const MaterialTable materials(section);
  const float depth = mean_spacing(section.source_spacing);
  const int stride =
      std::max(1, static_cast<int>(kHalf * grid.spacing / mean_spacing(section.spacing)));
  for (const Plane& end : section.ends()) {
    const Vec3 outward = -end.normal;
    std::vector<SurfacePoint> points;
    const auto look = [&](const IVec3& voxel) {
      const Vec3 sampled = section.sample(Vec3(voxel));
      const FaceMaterial& material = materials.of_value(section.value(sampled));
      if (std::exp(-material.extinction * depth) < kHalf) {
        const Vec3 tint = section.channels == 3 ? photo_albedo(sampled) : Vec3(1);
        points.push_back({section.world_from_index(Vec3(voxel)), outward, material.surface * tint});
      }
    };
    // The slice at this end.
    IVec3 first(0);
    IVec3 last = section.dims - 1;
    for (int axis = 0; axis < 3; ++axis) {
      const float along = glm::dot(outward, section.direction[axis]);
      first[axis] = along > kHalf ? last[axis] : first[axis];
      last[axis] = along < -kHalf ? 0 : last[axis];
    }
    for (int z = first.z; z <= last.z; z += stride) {
      for (int y = first.y; y <= last.y; y += stride) {
        for (int x = first.x; x <= last.x; x += stride) {
          look({x, y, z});
        }
      }
    }
    const Vec3 white = face_diffuse(section.rig, outward);
    const Patches patches(grid, points);
    for (const SurfacePoint& point : patches.all()) {
      shown.add(point, white);
    }
  }
}

/// `thick`: in cells.
Gaussians discs_of(const Section& section, const Shown& shown, float spacing,
                   float thick = kThick) {
  const DisplayCurve& display = display_curve(section.tone);
  Gaussians discs(shown.points.size(), 0);
  for (size_t i = 0; i < discs.size(); ++i) {
    const Vec3 seen = section.exposure * shown.radiance[i];
    place({shown.points[i].position, shown.points[i].normal,
           Vec3(display(seen.r), display(seen.g), display(seen.b)), kWide * spacing,
           thick * spacing, kOpacity},
          i, discs);
  }
  return discs;
}

}  // namespace

Gaussians surface_splats(const Section& section, const SurfaceScan& scan, const Openings& openings,
                         size_t count) {
  const PatchGrid& light = openings.light().patches().grid();
  const auto lit = static_cast<size_t>(std::ranges::count_if(
      openings.own_light(), [](const Vec3& l) { return Openings::is_lit(l); }));
  const PatchGrid grid = grid_of(light, std::max<size_t>(1, lit), count);
  Shown shown;
  add_lit_surfaces(Patches(grid, colored(scan)), openings, shown);
  add_ends(section, grid, shown);
  return discs_of(section, shown, grid.spacing);
}

Gaussians wall_splats(const Section& section, const SurfaceScan& scan, const Openings& openings,
                      const Cut& cut, size_t most) {
  const Patches& light = openings.light().patches();
  const std::vector<Vec3> solution = openings.solve(cut.planes());
  size_t opened = 0;
  for (size_t i = 0; i < solution.size(); ++i) {
    opened += Openings::is_lit(solution[i]) && !Openings::is_lit(openings.own_light()[i]) ? 1 : 0;
  }
  if (opened == 0) {
    return Gaussians(0, 0);
  }
  // Finer than the light itself, but not as fine as a few patches would allow.
  constexpr size_t kFiner = 16;
  const PatchGrid grid = grid_of(light.grid(), opened, std::min(most, kFiner * opened));
  Shown shown;
  const Patches patches(grid, colored(scan));
  for (const SurfacePoint& point : patches.all()) {
    const Vec3 uncut = light_at(light, openings.own_light(), point.position, point.normal);
    const Vec3 white = light_at(light, solution, point.position, point.normal);
    if (is_kept(point.position, cut) && Openings::is_lit(white) && !Openings::is_lit(uncut)) {
      shown.add(point, white);
    }
  }
  return discs_of(section, shown, grid.spacing);
}

KeptSurfaces kept_surfaces(const Section& section, const SurfaceScan& scan,
                           const Openings& openings, const Cut& cut, size_t most) {
  const Patches& light = openings.light().patches();
  const std::vector<Vec3> solution = openings.solve(cut.planes());
  size_t lit = 0;
  for (size_t i = 0; i < solution.size(); ++i) {
    lit += Openings::is_lit(solution[i]) && is_kept(light.all()[i].position, cut) ? 1 : 0;
  }
  const float finer = light.grid().spacing / (kFinest * mean_spacing(section.spacing));
  const auto finest = static_cast<size_t>(finer * finer * static_cast<float>(lit));
  const PatchGrid grid =
      grid_of(light.grid(), std::max<size_t>(1, lit), std::max<size_t>(1, std::min(most, finest)));
  const Patches patches(grid, on_walls(section, openings, colored(scan)));
  Shown shown;
  Shown dark;
  for (const SurfacePoint& point : patches.all()) {
    if (is_kept(point.position, cut)) {
      const Vec3 white = light_at(light, solution, point.position, point.normal);
      (Openings::is_lit(white) ? shown : dark).add(point, white);
    }
  }
  const size_t shown_lit = shown.points.size();
  shown.add(dark);
  return {discs_of(section, shown, grid.spacing, kThin), shown_lit};
}

}  // namespace clipgs
