#include "volume/hints.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <vector>

namespace clipgs {
namespace {

struct ModalityWord {
  std::string_view word;
  Modality modality;
};

/// DICOM's defined terms, MetaImage's (MET_MOD_...), and what people write in NRRD's keys.
constexpr std::array kModalityTerms = {ModalityWord{"CT", Modality::kCt},
                                       ModalityWord{"MR", Modality::kMr},
                                       ModalityWord{"MRI", Modality::kMr},
                                       ModalityWord{"MRT", Modality::kMr},
                                       ModalityWord{"TE", Modality::kMr},
                                       ModalityWord{"PT", Modality::kPet},
                                       ModalityWord{"PET", Modality::kPet},
                                       ModalityWord{"US", Modality::kUltrasound},
                                       ModalityWord{"ULTRASOUND", Modality::kUltrasound}};

struct RegionWord {
  std::string_view word;
  BodyRegion region;
  bool whole = false;  ///< the word itself, not what begins with it
};

/// DICOM's terms for body parts (PS3.16 annex L) and common words of descriptions; the first of a
/// text's words counts.
constexpr std::array kRegionWords = {
    RegionWord{"DENT", BodyRegion::kTeeth},       RegionWord{"TEETH", BodyRegion::kTeeth},
    RegionWord{"TOOTH", BodyRegion::kTeeth},      RegionWord{"JAW", BodyRegion::kTeeth},
    RegionWord{"MANDIB", BodyRegion::kTeeth},     RegionWord{"MAXILLA", BodyRegion::kTeeth},
    RegionWord{"CBCT", BodyRegion::kTeeth, true}, RegionWord{"HEAD", BodyRegion::kHead, true},
    RegionWord{"HEADNECK", BodyRegion::kHead},    RegionWord{"BRAIN", BodyRegion::kHead},
    RegionWord{"SKULL", BodyRegion::kHead},       RegionWord{"CRAN", BodyRegion::kHead},
    RegionWord{"CEREBR", BodyRegion::kHead},      RegionWord{"NEURO", BodyRegion::kHead},
    RegionWord{"CHEST", BodyRegion::kChest},      RegionWord{"THORAX", BodyRegion::kChest},
    RegionWord{"LUNG", BodyRegion::kChest},       RegionWord{"HEART", BodyRegion::kChest},
    RegionWord{"CARDIAC", BodyRegion::kChest},    RegionWord{"ABDOM", BodyRegion::kAbdomen},
    RegionWord{"PELVIS", BodyRegion::kAbdomen},   RegionWord{"LIVER", BodyRegion::kAbdomen},
    RegionWord{"KIDNEY", BodyRegion::kAbdomen},   RegionWord{"EXTREMITY", BodyRegion::kLimb},
    RegionWord{"KNEE", BodyRegion::kLimb},        RegionWord{"HAND", BodyRegion::kLimb, true},
    RegionWord{"WRIST", BodyRegion::kLimb},       RegionWord{"FOOT", BodyRegion::kLimb, true},
    RegionWord{"ANKLE", BodyRegion::kLimb},       RegionWord{"ELBOW", BodyRegion::kLimb},
    RegionWord{"WHOLEBODY", BodyRegion::kWhole}};

constexpr std::array<std::string_view, 4> kAngiographyWords{"CTA", "MRA", "TOF", "ANGIO"};
constexpr size_t kLongestAcronym = 3;  // ANGIO may go on, CTA may not

/// Letters and digits that stand together, in capitals.
std::vector<std::string> capital_words(std::string_view text) {
  std::vector<std::string> found(1);
  for (const char c : text) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isalnum(letter) != 0) {
      found.back() += static_cast<char>(std::toupper(letter));
    } else if (!found.back().empty()) {
      found.emplace_back();
    }
  }
  return found;
}

}  // namespace

void Hints::learn_modality(std::string_view text) {
  for (const std::string& word : capital_words(text)) {
    const auto* const term = std::ranges::find(kModalityTerms, word, &ModalityWord::word);
    if (modality == Modality::kUnknown && term != kModalityTerms.end()) {
      modality = term->modality;
    }
  }
}

void Hints::learn_words(std::string_view text) {
  for (const std::string& word : capital_words(text)) {
    const auto* const known = std::ranges::find_if(kRegionWords, [&](const RegionWord& one) {
      return one.whole ? word == one.word : word.starts_with(one.word);
    });
    if (region == BodyRegion::kUnknown && known != kRegionWords.end()) {
      region = known->region;
    }
    angiography = angiography || std::ranges::any_of(kAngiographyWords, [&](std::string_view one) {
                    return one.size() > kLongestAcronym ? word.starts_with(one) : word == one;
                  });
  }
}

void Hints::learn_part(std::string_view text) {
  learn_words(text);
  if (part == BodyPart::kUnknown) {
    part = body_part_of_term(text).value_or(BodyPart::kUnknown);
  }
}

void Hints::learn_agent(std::string_view text) {
  const std::string first = capital_words(text).front();
  contrast = !first.empty() && first != "NONE" && first != "NO" && first != "WITHOUT";
}

}  // namespace clipgs
