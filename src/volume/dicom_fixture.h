#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace clipgs {

/// One DICOM image for a test to write.
struct FixtureSlice {
  std::string series_uid = "1.2.826.0.1.3680043.2.1125.1";
  std::string modality = "CT";
  int instance = 1;
  int columns = 16;
  int rows = 12;
  glm::dvec3 position{0};
  glm::dvec3 row{1, 0, 0};
  glm::dvec3 column{0, 1, 0};
  glm::dvec2 pixel_spacing{1, 1};  ///< between columns, between rows
  double slope = 1;
  double intercept = -1024;
  std::vector<std::int16_t> pixels;  ///< as stored, rows × columns
};

/// Writes an uncompressed DICOM file.
void write_dicom(const std::filesystem::path& path, const FixtureSlice& slice);

}  // namespace clipgs
