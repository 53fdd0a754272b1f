#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/image.h"

namespace clipgs {

/// An image that something was made of.
struct SourceImage {
  std::string sop_class;     ///< UID
  std::string sop_instance;  ///< UID
};

/// What a new DICOM object is derived from.
struct DerivedFrom {
  std::filesystem::path file;       ///< one of the series: whose patient and study it is
  std::vector<SourceImage> images;  ///< all of the series; empty: no reference is made
  std::string content;              ///< of the images, a digest: the same gives the same UIDs
};

/// Pictures for an archive, one after the other.
struct DicomFilm {
  std::vector<Image> pictures;  ///< RGB, display sRGB, all of one size
  float frames_per_second = 12;
  std::string comment;  ///< ASCII: what stands beside it (Image Comments)
};

/// The bytes of a DICOM file: a Multi-frame True Color Secondary Capture (PS3.3 A.8.5), not
/// compressed, as every archive and viewer reads it. Of the source it has the patient's and the
/// study's attributes (PS3.3 C.7.1.1, C.7.2.1, C.7.2.2) and nothing else. The same input gives the
/// same bytes. Throws Error if the source cannot be read or tells no study.
std::string film_object(const DerivedFrom& source, const DicomFilm& film);

/// The same for a document: an Encapsulated PDF (PS3.3 A.45.1).
std::string report_object(const DerivedFrom& source, const std::string& pdf);

/// Whom the two are made by, as they say it (Manufacturer): nothing is built of them.
inline constexpr const char* kDerivedBy = "clipgs";

/// A UID (PS3.5 B.2) that is the same for the same names, below the root of UUIDs, 2.25.
std::string derived_uid(const std::string& content, const std::string& what);

}  // namespace clipgs
