#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace clipgs {

/// One DICOM image for a test to write.
struct FixtureSlice {
  std::string patient{};  ///< ID
  std::string study_uid = "1.2.826.0.1.3680043.2.1125.0";
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
  std::optional<std::int16_t> padding{};        ///< as stored
  std::optional<std::int16_t> padding_limit{};  ///< the other end of a range of them
  std::vector<std::int16_t> pixels;             ///< as stored, rows × columns
  struct Text {
    std::uint16_t group = 0;
    std::uint16_t element = 0;
    std::string value;
    bool integer = false;  ///< an integer string, not a decimal one
  };
  std::vector<Text> texts;  ///< further elements
};

/// A function that linear resampling keeps: HU at an LPS position.
double fixture_truth(const glm::dvec3& lps);

/// The pixels become fixture_truth() of their places, plus `added`.
void fill(FixtureSlice& slice, double added = 0);

/// Writes an uncompressed DICOM file.
void write_dicom(const std::filesystem::path& path, const FixtureSlice& slice);

/// How a file of many frames is written.
struct FixtureFrames {
  bool defined_lengths = false;        ///< of sequences and items; else delimiters end them
  bool rle = false;                    ///< compressed, one piece a frame
  std::vector<std::uint32_t> times{};  ///< temporal position index of each frame, if any
};

/// Writes one file (enhanced, by PS3.3 C.7.6.16) of the slices, in their order. The first one's
/// orientation, pixels, slope and intercept hold for all.
void write_frames(const std::filesystem::path& path, const std::vector<FixtureSlice>& slices,
                  const FixtureFrames& how = {});

/// Writes one filled slice per position along the table (z), instance numbers from 1, in an order
/// that the names do not follow.
void write_series(const std::filesystem::path& folder, const std::vector<double>& table,
                  FixtureSlice slice, const std::string& prefix = "i", double added = 0);

/// `slices` positions from -20 mm on.
std::vector<double> even_table(int slices, double step);

}  // namespace clipgs
