#pragma once

#include <filesystem>

#include "volume/stored_image.h"
#include "volume/volume_size.h"

namespace clipgs {

/// What the header of such a file, see below, says of its size. Throws Error.
VolumeSize image_file_size(const std::filesystem::path& path, int frame = 0);

/// Reads a NIfTI (.nii, .nii.gz, .hdr with .img), NRRD (.nrrd, .nhdr) or MetaImage (.mha, .mhd)
/// file. Every number of the header is checked first, and that every byte of voxels is there.
/// `check` sees what the header says of the size before the voxels are read. `frame` counts the
/// volumes of a 4D file from 1; 0: the file must hold one. Warns of what the header leaves open.
/// Throws Error.
StoredImage read_image_file(const std::filesystem::path& path, int frame = 0,
                            const SizeCheck& check = {});

}  // namespace clipgs
