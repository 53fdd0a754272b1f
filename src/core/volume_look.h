#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "core/body_part.h"
#include "core/defaced.h"
#include "core/json_reader.h"
#include "core/modality.h"

namespace clipgs {

/// Which volume is shown, and how. What is made of one volume with several presets is one anatomy
/// in several looks. Nothing of it says where the volume is from, or of whom.
struct VolumeLook {
  std::string volume;       ///< 16 hexadecimal digits, the same for all looks of a volume; or empty
  std::string title;        ///< the preset's
  std::string description;  ///< the preset's, a sentence
  Modality modality = Modality::kUnknown;
  BodyPart part = BodyPart::kUnknown;
  std::optional<Defaced> defaced = std::nullopt;  ///< what went with the face; none: nothing

  bool operator==(const VolumeLook&) const = default;
};

inline constexpr const char* kLookKey = "look";

/// Of the volume with that digest (Digest::hex(), or empty), with texts cut to what files hold.
VolumeLook make_volume_look(const std::string& digest, const std::string& title,
                            const std::string& description);

/// What a case of it is called that nobody has named: "Head, skin and bone", or, where the part of
/// the body is not known, "CT, skin and bone" or "MR volume": never a look's name alone. `preset`:
/// its name, for looks without a title.
std::string usual_title(const VolumeLook& look, const std::string& preset);

/// As the value of kLookKey; null if neither the volume nor what it shows of the body is known.
nlohmann::json volume_look_json(const VolumeLook& look);
/// From the object's kLookKey; all empty where it has none. Throws Error.
VolumeLook read_volume_look(const JsonReader& object);

}  // namespace clipgs
