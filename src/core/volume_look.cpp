#include "core/volume_look.h"

#include <algorithm>
#include <cctype>

#include "core/utf8.h"

namespace clipgs {
namespace {

// Enough for one not to be taken for another, and too few to be of use for anything else.
constexpr size_t kVolumeDigits = 16;

std::string beginning(const std::string& text) {
  return utf8_beginning(text, JsonReader::kMostText);
}

bool is_lower(char c) { return std::islower(static_cast<unsigned char>(c)) != 0; }

/// "Skin and bone" as it stands within a title; "MR" and "X-ray" stay as they are.
std::string within_title(std::string text) {
  if (text.size() > 1 && is_lower(text[1])) {
    text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  }
  return text;
}

std::string begin_title(std::string text) {
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

Modality modality_of_name(const std::string& name) {
  const auto* const found =
      std::ranges::find_if(kModalities, [&](Modality one) { return modality_name(one) == name; });
  return found == kModalities.end() ? Modality::kUnknown : *found;
}

constexpr const char* kModalityKey = "modality";
constexpr const char* kPartKey = "region";
constexpr const char* kDefacedKey = "defaced";

Defaced read_defaced(const JsonReader& object) {
  const auto amount = [&](const char* key) {
    const float value = object.number(key);
    if (value < 0) {
      object.fail(key, "a number from 0");
    }
    return value;
  };
  return {amount("removed_ml"), amount("brain_mm")};
}

}  // namespace

VolumeLook make_volume_look(const std::string& digest, const std::string& title,
                            const std::string& description) {
  return {digest.substr(0, kVolumeDigits), beginning(title), beginning(description)};
}

std::string usual_title(const VolumeLook& look, const std::string& preset) {
  const std::string shown = within_title(look.title.empty() ? preset : look.title);
  const std::string subject = look.part != BodyPart::kUnknown       ? body_part_name(look.part)
                              : look.modality != Modality::kUnknown ? modality_name(look.modality)
                                                                    : "volume";
  if (shown.empty()) {
    return begin_title(subject);
  }
  if (shown.starts_with(subject)) {  // "MR" and "PET (hot metal)" are looks as well
    return look.modality == Modality::kPhoto
               ? "Photographic volume"
               : begin_title(subject) + " volume" + shown.substr(subject.size());
  }
  return begin_title(subject) + ", " + shown;
}

nlohmann::json volume_look_json(const VolumeLook& look) {
  if (look.volume.empty() && look.part == BodyPart::kUnknown) {
    return {};
  }
  nlohmann::json json = {
      {"volume", look.volume}, {"title", look.title}, {"description", look.description}};
  if (look.modality != Modality::kUnknown) {
    json[kModalityKey] = modality_name(look.modality);
  }
  if (look.part != BodyPart::kUnknown) {
    json[kPartKey] = body_part_name(look.part);
  }
  if (look.defaced) {
    json[kDefacedKey] = {{"removed_ml", json_number(look.defaced->removed_ml)},
                         {"brain_mm", json_number(look.defaced->brain_mm)}};
  }
  return json;
}

VolumeLook read_volume_look(const JsonReader& object) {
  if (!object.has(kLookKey)) {
    return {};
  }
  const JsonReader look = object.child(kLookKey);
  const auto word = [&](const char* key) { return look.has(key) ? look.text(key) : ""; };
  return {
      look.text("volume"),
      look.text("title"),
      look.text("description"),
      modality_of_name(word(kModalityKey)),
      body_part_of_term(word(kPartKey)).value_or(BodyPart::kUnknown),
      look.has(kDefacedKey) ? std::optional(read_defaced(look.child(kDefacedKey))) : std::nullopt};
}

}  // namespace clipgs
