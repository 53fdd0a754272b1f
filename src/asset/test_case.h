#pragma once

#include <memory>

#include "asset/case.h"
#include "section/surface_splats.h"
#include "section/test_section.h"

namespace clipgs::test {

/// A ball of which nothing is learnt: its surface is discs.
inline Case ball_case() {
  Case contents(Scene{}, ball_section());
  const SurfaceScan scan = scan_surfaces(*contents.section);
  contents.openings = std::make_shared<const Openings>(*contents.section, scan);
  contents.scene.gaussians = surface_splats(*contents.section, scan, *contents.openings, 8000);
  contents.scene.sphere = {{0, 0, 0}, 16};
  contents.scene.placed = true;
  return contents;
}

}  // namespace clipgs::test
