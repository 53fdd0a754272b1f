#pragma once

#include <memory>
#include <vector>

#include "volume/dicom_file.h"
#include "volume/pixel_decoder.h"

namespace clipgs {

/// Reads the pixels of grey images, one after the other. The file of the last stays in memory: one
/// of many frames is read once.
class DicomPixels {
 public:
  /// Pixels that their file calls padding become `fill`.
  explicit DicomPixels(float fill);
  ~DicomPixels();
  DicomPixels(const DicomPixels&) = delete;
  DicomPixels& operator=(const DicomPixels&) = delete;

  /// Slope and intercept applied, row by row. Only the pixels and the few facts that they need ever
  /// reach the decoder of compressed pixels. Throws Error.
  std::vector<float> read(const DicomHeader& known);

 private:
  struct File;
  float fill_;
  std::unique_ptr<File> file_;
  PixelDecoder decoder_;
};

}  // namespace clipgs
