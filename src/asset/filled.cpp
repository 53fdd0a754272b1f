#include "asset/filled.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <vector>

#include "asset/draw_case.h"
#include "asset/seen_colors.h"
#include "core/error.h"
#include "section/face_splats.h"
#include "section/material_table.h"
#include "section/surface_splats.h"
#include "splat/select.h"
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

/// Those in the matter of a section: around it, its surface is what is seen.
Gaussians in_matter(const Gaussians& gaussians, const Section& section) {
  const MaterialTable materials(section);
  return select(gaussians, [&](size_t i) {
    const Vec3 sampled = section.sample(section.index_from_world(gaussians.mean(i)));
    return materials.of_value(section.value(sampled)).extinction > 0;
  });
}

/// Without those within `spacing` mm or so of `discs`, which show what is there: skin, where they
/// are spotted, as they were trained behind what the section draws, and walls that no picture saw,
/// where they are noise.
Gaussians without_shown(const Gaussians& gaussians, const Gaussians& discs, float spacing) {
  using Cell = std::tuple<int, int, int>;
  const auto cell_of = [&](const Vec3& x) {
    const IVec3 cell(glm::floor(x / spacing));
    return Cell(cell.x, cell.y, cell.z);
  };
  std::set<Cell> shown;
  for (size_t i = 0; i < discs.size(); ++i) {
    shown.insert(cell_of(discs.mean(i)));
  }
  return select(gaussians, [&](size_t i) { return !shown.contains(cell_of(gaussians.mean(i))); });
}

// Of surfaces there are so many times as many discs as of faces, as light may fall on all of them.
constexpr size_t kOfSurfaces = 4;

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
  if (contents.openings && contents.openings->drawn()) {
    const Openings& openings = *contents.openings;
    Gaussians discs;
    if (draws_surface(contents)) {
      const KeptSurfaces kept =
          kept_surfaces(section, scan_surfaces(section, true), openings, cut, kOfSurfaces * most);
      discs = trim(in_seen_colors(contents, cut, kept.discs, kept.lit,
                                  std::min(1, scene.gaussians.sh_degree())),
                   planes);
      // Those of a case that was there at once are coarser discs of the same surfaces.
      parts[0] = scene.placed ? parts[0].like(0) : in_matter(parts[0], section);
    } else if (!cut.empty()) {
      discs = wall_splats(section, scan_surfaces(section), openings, cut, most / 2);
    }
    parts[0] = without_shown(parts[0], discs, openings.light().patches().grid().spacing);
    parts.push_back(discs);
  }
  return joined(parts, scene.gaussians.sh_degree());
}

}  // namespace clipgs
