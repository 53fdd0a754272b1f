#include "core/volume_look.h"

namespace clipgs {
namespace {

// Enough for one not to be taken for another, and too few to be of use for anything else.
constexpr size_t kVolumeDigits = 16;

/// The beginning that JsonReader::text() takes, of whole characters of UTF-8.
std::string beginning(const std::string& text) {
  constexpr unsigned kContinued = 0x80;  // and the mask 0xc0
  if (text.size() <= JsonReader::kMostText) {
    return text;
  }
  size_t end = JsonReader::kMostText;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0U) == kContinued) {
    --end;
  }
  return text.substr(0, end);
}

}  // namespace

VolumeLook make_volume_look(const std::string& digest, const std::string& title,
                            const std::string& description) {
  return {digest.substr(0, kVolumeDigits), beginning(title), beginning(description)};
}

nlohmann::json volume_look_json(const VolumeLook& look) {
  if (look.volume.empty()) {
    return {};
  }
  return {{"volume", look.volume}, {"title", look.title}, {"description", look.description}};
}

VolumeLook read_volume_look(const JsonReader& object) {
  if (!object.has(kLookKey)) {
    return {};
  }
  const JsonReader look = object.child(kLookKey);
  return {look.text("volume"), look.text("title"), look.text("description")};
}

}  // namespace clipgs
