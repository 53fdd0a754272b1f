#pragma once

#include <filesystem>

#include "volume/volume.h"

namespace clipgs {

/// Reads a segmentation from a NIfTI, NRRD or MetaImage file into volume.labels. It lies in the
/// same patient space on any grid: every voxel of the volume takes the label of the nearest voxel
/// there, and 0 outside. Throws Error for values that are not whole numbers, for more than 255
/// labels beside 0, and if none of them lies within the volume.
void add_labels(Volume& volume, const std::filesystem::path& path);

}  // namespace clipgs
