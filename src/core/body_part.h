#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace clipgs {

/// What of the body a volume shows.
enum class BodyPart {
  kUnknown,
  kHead,
  kJaw,
  kHeadAndNeck,
  kNeck,
  kShoulder,
  kChest,
  kHeart,
  kBreast,
  kAbdomen,
  kPelvis,
  kTrunk,  ///< several of chest, abdomen and pelvis, or one of them that is not known better
  kSpine,
  kArm,
  kHand,
  kHip,
  kLeg,
  kKnee,
  kFoot,
  kWholeBody
};

/// Words for them, in their order: all that options take, and cases hold.
inline constexpr std::array kBodyPartNames = {
    "",      "head",   "jaw",     "head and neck", "neck",  "shoulder",  "chest",
    "heart", "breast", "abdomen", "pelvis",        "trunk", "spine",     "arm",
    "hand",  "hip",    "leg",     "knee",          "foot",  "whole body"};

/// "" of what is not known.
inline const char* body_part_name(BodyPart part) {
  return kBodyPartNames[static_cast<size_t>(part)];
}

/// Of one of these words, or of a term for body parts of DICOM's ("THORAX", "CSPINE"): all of the
/// text, but for what is no letter, in capitals or not. Nothing for others: what people write into
/// that field may be anything.
std::optional<BodyPart> body_part_of_term(std::string_view text);

/// "head, jaw, …"
std::string body_part_words();

}  // namespace clipgs
