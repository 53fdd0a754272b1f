#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/json_reader.h"

namespace clipgs {

/// Which volume is shown, and how. What is made of one volume with several presets is one anatomy
/// in several looks. Nothing of it says where the volume is from, or of whom.
struct VolumeLook {
  std::string volume;       ///< 16 hexadecimal digits, the same for all looks of a volume; or empty
  std::string title;        ///< the preset's
  std::string description;  ///< the preset's, a sentence

  bool operator==(const VolumeLook&) const = default;
};

inline constexpr const char* kLookKey = "look";

/// Of the volume with that digest (Digest::hex(), or empty), with texts cut to what files hold.
VolumeLook make_volume_look(const std::string& digest, const std::string& title,
                            const std::string& description);

/// As the value of kLookKey; null if the volume is not known.
nlohmann::json volume_look_json(const VolumeLook& look);
/// From the object's kLookKey; all empty where it has none. Throws Error.
VolumeLook read_volume_look(const JsonReader& object);

}  // namespace clipgs
