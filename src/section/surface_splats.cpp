#include "section/surface_splats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <vector>

#include "section/display_curve.h"
#include "section/face_light.h"
#include "section/material_table.h"

namespace clipgs {
namespace {

// Deviations of a disc, in sides of a cell: neighbours overlap so far that no gap is left between
// them, and no farther, for a picture of them is as blurred as they are wide.
constexpr float kWide = 0.65f;
constexpr float kThick = 0.15f;
constexpr float kOpacity = 0.95f;
constexpr float kShBand0 = 0.28209479f;  // the constant spherical harmonic

/// The grid of light, or a finer one with about `count` patches for `lit` of its own.
PatchGrid grid_of(const PatchGrid& light, size_t lit, size_t count) {
  const double finer = std::sqrt(static_cast<double>(count) / static_cast<double>(lit));
  PatchGrid grid = light;
  grid.spacing = light.spacing / static_cast<float>(finer);
  grid.dims = IVec3(glm::ceil(Vec3(light.dims - 1) * light.spacing / grid.spacing)) + 1;
  return grid;
}

Quat facing(const Vec3& normal) {
  Vec3 u;
  Vec3 v;
  orthonormal_basis(normal, u, v);
  return glm::quat_cast(Mat3(u, v, normal));
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

/// What discs show: places, and what the eye sees there, linear RGB before exposure.
struct Shown {
  std::vector<SurfacePoint> points;
  std::vector<Vec3> radiance;

  void add(const SurfacePoint& point, const Vec3& white) {
    points.push_back(point);
    radiance.push_back(point.reflectance * white);
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

/// The patch as a disc.
void place(const SurfacePoint& point, const Vec3& color, float spacing, size_t i,
           Gaussians& discs) {
  const Quat rotation = facing(point.normal);
  const std::array<float, 4> wxyz = {rotation.w, rotation.x, rotation.y, rotation.z};
  for (int a = 0; a < 3; ++a) {
    discs.plane(Gaussians::kMean + a)[i] = point.position[a];
    discs.plane(Gaussians::kLogScale + a)[i] = std::log((a == 2 ? kThick : kWide) * spacing);
    discs.plane(Gaussians::kSh + a)[i] = (color[a] - 0.5f) / kShBand0;
  }
  for (int k = 0; k < 4; ++k) {
    discs.plane(Gaussians::kRotation + k)[i] = wxyz[static_cast<size_t>(k)];
  }
  discs.plane(Gaussians::kOpacity)[i] = std::log(kOpacity / (1 - kOpacity));
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
  const DisplayCurve& display = display_curve(section.tone);
  Gaussians discs(shown.points.size(), 0);
  for (size_t i = 0; i < discs.size(); ++i) {
    const Vec3 seen = section.exposure * shown.radiance[i];
    place(shown.points[i], {display(seen.r), display(seen.g), display(seen.b)}, grid.spacing, i,
          discs);
  }
  return discs;
}

}  // namespace clipgs
