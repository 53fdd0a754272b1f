#pragma once

#include <string>

#include "cinema/make_dataset.h"
#include "core/claim.h"
#include "core/volume_look.h"

namespace clipgs {

/// What a dataset's pictures, and the points beside them, are made of.
struct DatasetClaims {
  Claim pictures;
  Claim points;
};

/// By content: of the volume as it was loaded, so that no option of loading can be forgotten, of
/// the labels' looks, the preset and its lights (a panorama's pixels too), whatever files they are
/// from.
DatasetClaims claims_of(const Volume& volume, const Preset& preset, const DatasetOptions& options);

/// How the preset shows the volume: the digest in it is of the volume alone, the same for every
/// preset and whatever is made of it.
VolumeLook look_of(const DatasetClaims& claims, const Volume& volume, const Preset& preset);

}  // namespace clipgs
