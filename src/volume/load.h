#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "volume/deface.h"
#include "volume/gaps.h"
#include "volume/prepare.h"
#include "volume/rescale.h"
#include "volume/volume.h"
#include "volume/volume_size.h"

namespace clipgs {

/// Which volume is read of what a path holds, and what is done to it.
struct LoadOptions {
  /// DICOM series UID or 1-based number in the list of series and phases; empty: that of the file
  /// given, or the largest (of phases alike in size the first).
  std::string series;
  int frame = 0;                   ///< volume of a 4D file, from 1; 0: the file must hold one
  Gaps gaps = Gaps::kInterpolate;  ///< what to do where a few slices of a series are missing
  std::optional<Rescale> hu;       ///< --hu scale,offset; empty: values as stored
  /// --modality: instead of what is guessed, and of what headers say that are no DICOM. Unknown: go
  /// by those.
  Modality modality = Modality::kUnknown;
  BodyPart part = BodyPart::kUnknown;  ///< --region: instead of what a header or the voxels tell
  bool keep_table = false;             ///< leave what a CT shows beside the patient
  bool deface = false;                 ///< then take the face off a head (deface())
  PrepareOptions prepare;              ///< what is done to the volume after that
  std::filesystem::path labels;        ///< segmentation of the volume (add_labels()); empty: none
  /// Bytes of memory that the caller will take beside the loaded volume. Where loading or that is
  /// more than there is, an Error says so before any voxel is read, and again for what a crop
  /// leaves. Empty: nothing is checked.
  std::function<std::uint64_t(const VolumeSize&)> work;
  bool warn_of_size = false;  ///< a warning instead of that Error
  bool warn_of_face = false;  ///< a warning where a face is shown (shows_face())
  /// Is shown a volume before and after its face is taken off. Empty: nobody is.
  std::function<void(const Volume&)> watch_deface;
};

/// One series of a DICOM folder, or one phase of it, as a person tells them apart.
struct SeriesInfo {
  std::string uid;
  std::string modality;  ///< "CT", "MR", ...
  int number = 0;        ///< DICOM's series number
  std::string phase;     ///< what sets it apart from others at the same places; may be empty
  IVec3 dims{0};         ///< columns, rows, slices as stored
  bool taken = false;    ///< it is the volume
};

/// A volume, what was done to it, and what there was to choose from.
struct LoadedVolume {
  Volume volume;
  std::vector<PreparationStep> prepared;  ///< in their order
  std::optional<Face> face;               ///< that was taken off
  std::vector<SeriesInfo> series;  ///< of DICOM, in the order in which LoadOptions::series counts
};

/// Reads a DICOM folder (or the series of one file of it), NIfTI, NRRD or MetaImage file,
/// converts LPS to RAS, flips and permutes axes to run R, A, S, and resamples tilted gantries
/// and uneven slice spacing to a regular grid (with a warning that says what was done). Throws
/// Error for anything it cannot make sense of: truncated or corrupt files, no image in a folder,
/// missing slices (more than a few, see Gaps), zero-size, NaN or constant data. Colour volumes
/// become photographs. A modality that contradicts the values (LoadOptions::modality) or a DICOM
/// header is an Error. Several series or phases are listed in a warning. CT is cut off at −1024
/// HU: scanners mark pixels outside their field with less. Table and cushions are taken off a CT
/// (isolate_body()), with a warning that says how much.
Volume load_volume(const std::filesystem::path& path, const LoadOptions& options = {});

/// What headers say of the volume's size, labels and kept values included, without reading voxels;
/// of a crop they know nothing. Throws Error.
VolumeSize volume_size(const std::filesystem::path& path, const LoadOptions& options = {});

/// load_volume() that tells what was done, and what there was to choose from, as well.
LoadedVolume load_with_series(const std::filesystem::path& path, const LoadOptions& options = {});

/// Writes a scalar volume as NIfTI, NRRD or MetaImage by extension, atomically. Throws Error.
void save_volume(const std::filesystem::path& path, const Volume& volume);

}  // namespace clipgs
