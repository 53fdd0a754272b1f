#pragma once

#include "volume/steep_range.h"
#include "volume/transfer_function.h"

namespace clipgs {

/// What matter looks like where its values are steep: with the preset's own curve a transfer
/// function of value and gradient (Kniss, Kindlmann, Hansen 2002). Fascia between muscle and fat,
/// or the cortex about spongy bone, has the values of what lies beside it, but is steep. Extinction
/// and phase stay those of the value.
struct BoundaryLook {
  /// What a camera's ray meets less than so many mean voxels of the scan behind a cut face, which
  /// it entered in matter, looks as its value alone says: faces are drawn from values so far down
  /// (FaceRays), and there a gradient is a border between tissues that were cut, no surface.
  static constexpr float kFaceVoxels = 4;

  SteepRange range;           ///< how steep values are there
  TransferFunction transfer;  ///< albedo, specular and roughness alone count

  /// `plain`, what matter of the value looks like where it is even, with a share of this look.
  Material mixed(Material plain, float value, float share) const {
    const Material& steep = transfer.at(value);
    plain.albedo = glm::mix(plain.albedo, steep.albedo, share);
    plain.specular = glm::mix(plain.specular, steep.specular, share);
    plain.roughness = glm::mix(plain.roughness, steep.roughness, share);
    return plain;
  }
};

}  // namespace clipgs
