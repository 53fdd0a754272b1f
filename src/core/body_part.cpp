#include "core/body_part.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <span>

namespace clipgs {
namespace {

struct Term {
  std::string_view word;
  BodyPart part;
};

/// DICOM's terms (PS3.16 annex L) and those that scanners write in their place. Which limb an
/// EXTREMITY is, and where along it an AORTA is shown, they do not say.
constexpr Term kTerms[] = {{"BRAIN", BodyPart::kHead},
                           {"CEREBELLUM", BodyPart::kHead},
                           {"CIRCLEOFWILLIS", BodyPart::kHead},
                           {"EAR", BodyPart::kHead},
                           {"EYE", BodyPart::kHead},
                           {"FACE", BodyPart::kHead},
                           {"IAC", BodyPart::kHead},
                           {"NOSE", BodyPart::kHead},
                           {"ORBIT", BodyPart::kHead},
                           {"SINUS", BodyPart::kHead},
                           {"SKULL", BodyPart::kHead},
                           {"ZYGOMA", BodyPart::kHead},
                           {"DENTAL", BodyPart::kJaw},
                           {"MANDIBLE", BodyPart::kJaw},
                           {"MAXILLA", BodyPart::kJaw},
                           {"TEETH", BodyPart::kJaw},
                           {"TMJOINT", BodyPart::kJaw},
                           {"HEADNECK", BodyPart::kHeadAndNeck},
                           {"CAROTID", BodyPart::kNeck},
                           {"LARYNX", BodyPart::kNeck},
                           {"PHARYNX", BodyPart::kNeck},
                           {"THYROID", BodyPart::kNeck},
                           {"CLAVICLE", BodyPart::kShoulder},
                           {"SCAPULA", BodyPart::kShoulder},
                           {"BRONCHUS", BodyPart::kChest},
                           {"LUNG", BodyPart::kChest},
                           {"MEDIASTINUM", BodyPart::kChest},
                           {"RIB", BodyPart::kChest},
                           {"STERNUM", BodyPart::kChest},
                           {"THORAX", BodyPart::kChest},
                           {"CARDIAC", BodyPart::kHeart},
                           {"CORONARYARTERY", BodyPart::kHeart},
                           {"ADRENAL", BodyPart::kAbdomen},
                           {"COLON", BodyPart::kAbdomen},
                           {"GALLBLADDER", BodyPart::kAbdomen},
                           {"KIDNEY", BodyPart::kAbdomen},
                           {"LIVER", BodyPart::kAbdomen},
                           {"PANCREAS", BodyPart::kAbdomen},
                           {"SPLEEN", BodyPart::kAbdomen},
                           {"STOMACH", BodyPart::kAbdomen},
                           {"BLADDER", BodyPart::kPelvis},
                           {"PROSTATE", BodyPart::kPelvis},
                           {"RECTUM", BodyPart::kPelvis},
                           {"UTERUS", BodyPart::kPelvis},
                           {"ABDOMENPELVIS", BodyPart::kTrunk},
                           {"CHESTABDOMEN", BodyPart::kTrunk},
                           {"CHESTABDPELVIS", BodyPart::kTrunk},
                           {"NECKCHEST", BodyPart::kTrunk},
                           {"NECKCHESTABDOMEN", BodyPart::kTrunk},
                           {"NECKCHESTABDPELV", BodyPart::kTrunk},
                           {"TAP", BodyPart::kTrunk},
                           {"COCCYX", BodyPart::kSpine},
                           {"CSPINE", BodyPart::kSpine},
                           {"CTSPINE", BodyPart::kSpine},
                           {"LSPINE", BodyPart::kSpine},
                           {"LSSPINE", BodyPart::kSpine},
                           {"SSPINE", BodyPart::kSpine},
                           {"TLSPINE", BodyPart::kSpine},
                           {"TSPINE", BodyPart::kSpine},
                           {"ELBOW", BodyPart::kArm},
                           {"FOREARM", BodyPart::kArm},
                           {"HUMERUS", BodyPart::kArm},
                           {"RADIUS", BodyPart::kArm},
                           {"ULNA", BodyPart::kArm},
                           {"FINGER", BodyPart::kHand},
                           {"THUMB", BodyPart::kHand},
                           {"WRIST", BodyPart::kHand},
                           {"CALF", BodyPart::kLeg},
                           {"FEMUR", BodyPart::kLeg},
                           {"FIBULA", BodyPart::kLeg},
                           {"THIGH", BodyPart::kLeg},
                           {"TIBIA", BodyPart::kLeg},
                           {"PATELLA", BodyPart::kKnee},
                           {"ANKLE", BodyPart::kFoot},
                           {"CALCANEUS", BodyPart::kFoot},
                           {"TOE", BodyPart::kFoot}};

/// The letters of a text, in capitals.
std::string capitals(std::string_view text) {
  std::string letters;
  for (const char c : text) {
    if (c >= 'a' && c <= 'z') {
      letters += static_cast<char>(c - 'a' + 'A');
    } else if (c >= 'A' && c <= 'Z') {
      letters += c;
    }
  }
  return letters;
}

}  // namespace

std::optional<BodyPart> body_part_of_term(std::string_view text) {
  const std::string letters = capitals(text);
  const auto* const name = std::ranges::find_if(
      kBodyPartNames, [&](const char* one) { return *one != 0 && capitals(one) == letters; });
  if (name != kBodyPartNames.end()) {
    return static_cast<BodyPart>(name - kBodyPartNames.begin());
  }
  const Term* const term = std::ranges::find(kTerms, letters, &Term::word);
  return term == std::end(kTerms) ? std::nullopt : std::optional(term->part);
}

std::string body_part_words() {
  return fmt::format("{}", fmt::join(std::span(kBodyPartNames).subspan(1), ", "));
}

}  // namespace clipgs
