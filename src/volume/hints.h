#pragma once

#include <optional>
#include <string_view>

#include "core/body_part.h"
#include "core/geometry.h"
#include "core/modality.h"

namespace clipgs {

enum class BodyRegion { kUnknown, kHead, kTeeth, kChest, kAbdomen, kTrunk, kLimb, kWhole };

/// What the header of a volume's file says of it. Words of the header are matched against fixed
/// lists (hints.cpp) and never kept: no text of a file, and nothing that tells who the patient is.
struct Hints {
  Modality modality = Modality::kUnknown;
  BodyRegion region = BodyRegion::kUnknown;
  BodyPart part = BodyPart::kUnknown;  ///< what DICOM's field for it says, and nothing else
  bool angiography = false;
  bool contrast = false;      ///< an agent was given
  std::optional<Vec2> shown;  ///< values that the header wants black and white, the first smaller

  /// What words say of the modality: "CT", "MET_MOD_MR", "PT"; "TE=2.9" as converters to NIfTI
  /// write it for MR alone. What is known already stays.
  void learn_modality(std::string_view text);
  /// What words of a description say of the region and of angiography: "CTA neck", "TOF", "CBCT".
  void learn_words(std::string_view text);
  /// The same of DICOM's Body Part Examined, which also is the part if it is one of the terms for
  /// it and no more.
  void learn_part(std::string_view text);
  /// Whether the name of a contrast agent is one: there, and not "none".
  void learn_agent(std::string_view text);
};

}  // namespace clipgs
