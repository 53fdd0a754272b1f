#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "core/geometry.h"

namespace clipgs {

/// An image as a file stores it, before anything is made of it; LPS millimetres as in DICOM.
struct StoredImage {
  IVec3 dims{0};
  glm::dvec3 spacing{1};
  glm::dmat3 direction{1};        ///< columns: LPS directions of the index axes
  glm::dvec3 origin{0};           ///< LPS mm of the centre of voxel (0, 0, 0)
  bool eight_bit = false;         ///< stored as 8-bit integers
  std::vector<float> values;      ///< scalar images: rescaled by the file's slope and intercept
  std::vector<std::uint8_t> rgb;  ///< colour images, 3 a voxel; values is then empty
};

/// Larger volumes are refused before anything is allocated (2^31 voxels are 8 GiB of floats).
constexpr std::uint64_t kMaxVoxels = std::uint64_t{1} << 31;

/// Reads a NIfTI, NRRD or MetaImage file. Throws Error.
StoredImage read_image_file(const std::filesystem::path& path);

/// What the header of one DICOM image says; nothing that tells who the patient is.
struct DicomHeader {
  std::filesystem::path path;
  std::string series_uid;
  std::string modality;  ///< "CT", "MR", ...
  int series_number = 0;
  int instance = 0;
  int columns = 0;
  int rows = 0;
  int frames = 1;
  bool placed = false;             ///< it has a position and an orientation
  glm::dvec3 position{0};          ///< LPS mm of the centre of the first pixel
  glm::dvec3 row{1, 0, 0};         ///< LPS direction along a row (growing column index)
  glm::dvec3 column{0, 1, 0};      ///< LPS direction along a column
  glm::dvec2 pixel_spacing{1, 1};  ///< mm between columns, between rows
};

/// True if the file starts like DICOM ("DICM" at byte 128).
bool is_dicom_file(const std::filesystem::path& path);

/// Headers of all DICOM images in the folder and its subfolders, in the order of their paths.
/// Throws Error for DICOM files that cannot be parsed.
std::vector<DicomHeader> scan_dicom(const std::filesystem::path& folder);

/// Pixels of one DICOM file, slope and intercept applied; several frames come as a volume. Throws
/// Error.
StoredImage read_dicom_image(const std::filesystem::path& path);

}  // namespace clipgs
