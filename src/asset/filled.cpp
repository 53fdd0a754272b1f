#include "asset/filled.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <vector>

#include "core/error.h"
#include "section/face_splats.h"
#include "section/surface_splats.h"
#include "splat/trim.h"

namespace clipgs {

namespace {

/// All of them, of one SH degree.
Gaussians joined(const std::vector<Gaussians>& parts, int sh_degree) {
  size_t count = 0;
  for (const Gaussians& part : parts) {
    count += part.size();
  }
  Gaussians all(count, sh_degree);
  size_t at = 0;
  for (const Gaussians& part : parts) {
    const Gaussians same = part.reshaped(sh_degree, false);
    for (int p = 0; p < all.planes(); ++p) {
      std::copy_n(same.plane(p), same.size(), all.plane(p) + at);
    }
    at += same.size();
  }
  return all;
}

/// Without those where a cut lets light into the dark: pictures saw them through no gap, and what
/// they show there is noise. `walls` show it now, which lie `spacing` mm apart.
Gaussians without_dark(const Gaussians& gaussians, const Gaussians& walls, float spacing) {
  using Cell = std::tuple<int, int, int>;
  const auto cell_of = [&](const Vec3& x) {
    const IVec3 cell(glm::floor(x / spacing));
    return Cell(cell.x, cell.y, cell.z);
  };
  std::set<Cell> dark;
  for (size_t i = 0; i < walls.size(); ++i) {
    dark.insert(cell_of(walls.mean(i)));
  }
  std::vector<size_t> kept;
  for (size_t i = 0; i < gaussians.size(); ++i) {
    if (!dark.contains(cell_of(gaussians.mean(i)))) {
      kept.push_back(i);
    }
  }
  return gaussians.gather(kept);
}

}  // namespace

Gaussians filled_splats(const Case& contents, const Cut& cut, size_t most) {
  if (contents.model) {
    throw Error("a neural model has no splats of its own to export; make a scene with clipgs bake");
  }
  const Scene& scene = contents.scene;
  std::vector<Plane> planes(cut.planes().begin(), cut.planes().end());
  if (!contents.section) {
    return joined({trim(scene.gaussians, planes)}, scene.gaussians.sh_degree());
  }
  const Section& section = *contents.section;
  std::ranges::copy(section.ends(), std::back_inserter(planes));
  std::vector<Gaussians> parts = {trim(scene.gaussians, planes)};
  // Discs of a case that was there at once are at the volume's ends already, coarser ones.
  parts.push_back(face_splats(section, scene.sphere, cut, most));
  if (!cut.empty()) {
    const SurfaceScan scan = scan_surfaces(section);
    const Openings openings(section, scan);
    if (openings.drawn()) {
      const Gaussians walls = wall_splats(section, scan, openings, cut, most / 2);
      parts[0] = without_dark(parts[0], walls, openings.light().patches().grid().spacing);
      parts.push_back(walls);
    }
  }
  return joined(parts, scene.gaussians.sh_degree());
}

}  // namespace clipgs
