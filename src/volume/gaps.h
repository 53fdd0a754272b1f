#pragma once

namespace clipgs {

/// What to do where a few slices of a DICOM series are missing.
enum class Gaps {
  kInterpolate,  ///< fill them from their neighbours, with a warning that says which
  kRefuse
};

}  // namespace clipgs
