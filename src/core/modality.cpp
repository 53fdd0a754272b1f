#include "core/modality.h"

#include <algorithm>

namespace clipgs {
namespace {

struct ModalityNames {
  Modality modality;
  const char* name;
  const char* word;
};

constexpr std::array kModalityNames = {ModalityNames{Modality::kCt, "CT", "ct"},
                                       ModalityNames{Modality::kMr, "MR", "mr"},
                                       ModalityNames{Modality::kPhoto, "photographs", "photo"},
                                       ModalityNames{Modality::kPet, "PET", "pet"},
                                       ModalityNames{Modality::kUltrasound, "ultrasound", "us"}};

}  // namespace

const char* modality_name(Modality modality) {
  const auto* const found = std::ranges::find(kModalityNames, modality, &ModalityNames::modality);
  return found == kModalityNames.end() ? "unknown" : found->name;
}

std::optional<Modality> modality_of_word(std::string_view word) {
  const auto* const found = std::ranges::find_if(
      kModalityNames, [&](const ModalityNames& names) { return names.word == word; });
  return found == kModalityNames.end() ? std::nullopt : std::optional(found->modality);
}

std::string modality_words() {
  std::string list;
  for (const ModalityNames& names : kModalityNames) {
    list += (list.empty() ? "" : ", ") + std::string(names.word);
  }
  return list;
}

}  // namespace clipgs
