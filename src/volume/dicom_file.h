#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "volume/dicom_elements.h"
#include "volume/dicom_source.h"
#include "volume/hints.h"

namespace clipgs {

/// What may set images at the same place apart, each as far as it is there.
struct DicomMarks {
  std::optional<double> temporal_position{};
  std::optional<double> temporal_index{};
  std::optional<double> trigger_ms{};  ///< after the heart's R wave
  std::optional<double> echo_ms{};
  std::optional<double> b_value{};  ///< s/mm², of diffusion
  std::optional<double> acquisition{};
  std::optional<double> acquired_s{};  ///< time of the day
  std::string image_type{};            ///< "ORIGINAL\\PRIMARY\\M", ...
};

/// Stored values from the first to the last; none where nothing else is said.
struct StoredRange {
  double first = 1;
  double last = 0;

  bool holds(double value) const { return value >= first && value <= last; }
};

/// What is said of one DICOM image; nothing that tells who the patient is.
struct DicomHeader {
  DicomSource source;
  std::string series_uid;
  std::string modality;  ///< "CT", "MR", ...
  int series_number = 0;
  int instance = 0;
  int columns = 0;
  int rows = 0;
  int frames = 1;                  ///< images in the file
  int frame = 0;                   ///< this one's number, from 0
  bool placed = false;             ///< it has a position and an orientation
  glm::dvec3 position{0};          ///< LPS mm of the centre of the first pixel
  glm::dvec3 row{1, 0, 0};         ///< LPS direction along a row (growing column index)
  glm::dvec3 column{0, 1, 0};      ///< LPS direction along a column
  glm::dvec2 pixel_spacing{1, 1};  ///< mm between columns, between rows
  DicomMarks marks;
  Hints hints;
  std::string transfer_syntax;  ///< UID
  std::string photometric;      ///< "MONOCHROME2", "RGB", ...
  int samples = 1;              ///< numbers a pixel
  int bits_allocated = 16;
  int bits_stored = 16;
  int high_bit = 15;
  bool is_signed = false;
  /// What means "no picture here" (PS3.3 C.7.5.1.1.2).
  StoredRange padding;
  double slope = 1;  ///< value = slope * stored + intercept
  double intercept = 0;
};

/// A pixel's number of the stored bits of `bits`, the others of which mean nothing.
double stored_number(const DicomHeader& header, std::uint32_t bits);

/// The images of a file: one, or its frames, each with its place as its functional groups say, or
/// as one distance or a list of distances between frames does. Of many frames without places only
/// the first, not placed. Nothing for files that hold no image (reports, DICOMDIR). Throws Error
/// for corrupt files.
std::vector<DicomHeader> dicom_headers(const DicomElements& elements, const DicomSource& source);
std::vector<DicomHeader> read_dicom_headers(const DicomSource& source);

/// A DICOM file that cannot be read: a slice of a series, if it could be read up to there.
struct UnreadableDicom {
  DicomSource source;
  std::string series_uid;  ///< empty: not known
  std::string error;       ///< what is wrong, one line
};

/// What the files of a folder turned out to be.
struct DicomScan {
  std::vector<DicomHeader> images;
  std::vector<UnreadableDicom> unreadable;
};

/// The headers of all images among the files. A file that cannot be read ends nothing: whether it
/// matters is known when a series has been chosen.
DicomScan scan_dicom(const std::vector<DicomSource>& sources);

}  // namespace clipgs
