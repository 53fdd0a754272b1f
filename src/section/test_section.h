#pragma once

#include "section/section.h"
#include "volume/phantom.h"
#include "volume/preset.h"

namespace clipgs::test {

/// A ball of 250 HU with a radius of 15 mm at the origin, in air.
inline Section ball_section() {
  return make_section(make_ball(40, 15, 250, -1000), load_preset("skin-and-bone"), {64});
}

}  // namespace clipgs::test
