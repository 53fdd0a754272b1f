#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace clipgs {

/// What made a volume's pictures, and with that what its values mean.
enum class Modality {
  kUnknown,
  kCt,         ///< Hounsfield units
  kMr,         ///< a signal without a unit
  kPhoto,      ///< colours of cryosections
  kPet,        ///< activity or uptake, of whatever unit
  kUltrasound  ///< echoes, mostly of 8 bits
};

inline constexpr std::array kModalities = {Modality::kUnknown, Modality::kCt,
                                           Modality::kMr,      Modality::kPhoto,
                                           Modality::kPet,     Modality::kUltrasound};

/// "CT", "MR", "photographs", "PET", "ultrasound", "unknown": for people, and in cases.
const char* modality_name(Modality modality);

/// As options and presets write it: ct, mr, photo, pet, us. Nothing for other words.
std::optional<Modality> modality_of_word(std::string_view word);
/// "ct, mr, photo, pet, us"
std::string modality_words();

}  // namespace clipgs
