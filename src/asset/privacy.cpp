#include "asset/privacy.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string_view>

#include "asset/case.h"
#include "asset/zip.h"
#include "core/body_part.h"
#include "core/file.h"

namespace clipgs {

using nlohmann::json;

namespace {

constexpr std::uintmax_t kMostCaseBytes = std::uintmax_t{1} << 30;
constexpr size_t kMostShown = 80;  // bytes of a value

/// What a key tells; "": nothing of the origin.
struct Known {
  std::string_view key;
  std::string_view what;
};

constexpr std::array kTopKeys = {
    Known{"version", ""},      Known{"asset", "the program that wrote the file"},
    Known{"count", ""},        Known{"means", ""},
    Known{"scales", ""},       Known{"quats", ""},
    Known{"sh0", ""},          Known{"shN", ""},
    Known{"clipgs_faces", ""}, Known{"clipgs", ""}};

constexpr std::string_view kPlace =
    "size of the body, and where it lay in the scanner's coordinates";

constexpr std::array kBlockKeys = {
    Known{"version", ""},
    Known{"generator", "the program that wrote the file"},
    Known{"world", ""},
    Known{"axis", ""},
    Known{"extent", kPlace},
    Known{"sphere", kPlace},
    Known{"bounds", kPlace},
    Known{"title", "as it was typed; untyped, region of the body and look"},
    Known{"whole_title", "as it was typed"},
    Known{"preset", "the look's name"},
    Known{"created", "the day on which the case was made, not that of the examination"},
    Known{"look", ""},
    Known{"checksums", ""},
    Known{"states", ""},
    Known{"face_gain", ""},
    Known{"trained", ""},
    Known{"splats", ""},
    Known{"section", ""},
    Known{"thumbnail", ""}};

constexpr std::array kLookKeys = {
    Known{"volume",
          "digest of the volume: who has the same volume can tell that this was made of "
          "it, nobody else"},
    Known{"title", "the look's name"},
    Known{"description", "the look's description"},
    Known{"modality", "kind of the examination"},
    Known{"region", "part of the body, of a fixed list"},
    Known{"defaced", "that its face was taken off, how much of it, and how far from the brain"}};

constexpr std::array kSectionKeys = {
    Known{"version", ""},      Known{"file", ""},
    Known{"coding", ""},       Known{"checksum", ""},
    Known{"dims", ""},         Known{"tile", ""},
    Known{"columns", ""},      Known{"channels", ""},
    Known{"origin", kPlace},   Known{"spacing", ""},
    Known{"axis_x", ""},       Known{"axis_y", ""},
    Known{"axis_z", ""},       Known{"source_spacing", "how far apart the scanned voxels were"},
    Known{"curve", ""},        Known{"modality", "kind of the examination"},
    Known{"value_errors", ""}, Known{"materials", ""},
    Known{"boundary", ""},     Known{"lights", ""}};

std::string shown(const json& value) {
  std::string text = value.is_string() ? value.get<std::string>()
                                       : value.dump(-1, ' ', false, json::error_handler_t::replace);
  if (text.size() > kMostShown) {
    text.resize(kMostShown);
    text += "…";
  }
  return text;
}

/// Notes of an object's keys, `prefix` before their names.
void note_keys(const json& object, const std::string& prefix, std::span<const Known> known,
               std::vector<PrivacyNote>& notes) {
  for (const auto& [key, value] : object.items()) {
    const auto found = std::ranges::find(known, std::string_view(key), &Known::key);
    if (found == known.end()) {
      notes.push_back({prefix + key, shown(value), "no clipgs writes this", true});
    } else if (!found->what.empty() && !shown(value).empty()) {
      notes.push_back({prefix + key, shown(value), std::string(found->what)});
    }
  }
}

/// Every text in some JSON: names of files, among others.
void collect_texts(const json& value, std::set<std::string>& texts) {
  if (value.is_string()) {
    texts.insert(value.get<std::string>());
  }
  for (const json& part : value.is_structured() ? value : json::array()) {
    collect_texts(part, texts);
  }
}

/// The chunks of a WebP that tell of a camera, a place or an editor.
std::string metadata_of(const Bytes& webp) {
  constexpr size_t kHeader = 12;
  constexpr size_t kChunk = 8;
  constexpr std::string_view kMark = "RIFF";
  std::string found;
  if (webp.size() < kHeader || !std::equal(kMark.begin(), kMark.end(), webp.begin())) {
    return found;
  }
  for (size_t at = kHeader; at + kChunk <= webp.size();) {
    const std::string name(webp.begin() + static_cast<std::ptrdiff_t>(at),
                           webp.begin() + static_cast<std::ptrdiff_t>(at + 4));
    std::uint32_t size = 0;
    std::memcpy(&size, &webp[at + 4], sizeof(size));
    if (name == "EXIF" || name == "XMP " || name == "ICCP") {
      found += found.empty() ? name : ", " + name;
    }
    at += kChunk + size + size % 2;
  }
  return found;
}

void note_files(const std::map<std::string, Bytes>& files, const json& meta,
                std::vector<PrivacyNote>& notes) {
  std::set<std::string> named = {"meta.json"};
  collect_texts(meta, named);
  for (const auto& [name, bytes] : files) {
    if (!named.contains(name)) {
      notes.push_back({name, fmt::format("{} bytes", bytes.size()), "no clipgs writes this", true});
    } else if (const std::string metadata = metadata_of(bytes); !metadata.empty()) {
      notes.push_back({name, metadata, "metadata of an image, which no clipgs writes", true});
    }
  }
}

/// What is left in a body.
void note_body(const CaseInfo& info, std::vector<PrivacyNote>& notes) {
  if (info.scene.look.defaced) {
    notes.push_back(
        {"the body", "",
         "its face was taken off (--deface); to whoever has other pictures of the person what is "
         "left may still tell who it is"});
    return;
  }
  constexpr std::array kFaces = {BodyPart::kHead, BodyPart::kHeadAndNeck, BodyPart::kJaw,
                                 BodyPart::kWholeBody, BodyPart::kUnknown};
  if (std::ranges::count(kFaces, info.scene.look.part) > 0) {
    notes.push_back(
        {"the body", "",
         "where it has a face, whoever knows the person may recognise it: in the splats, "
         "the section and the thumbnail"});
  }
}

void note_companions(const std::filesystem::path& path, std::vector<PrivacyNote>& notes) {
  for (const char* ending : {".marks.json", ".tour.json"}) {
    const std::filesystem::path beside = std::filesystem::path(path).replace_extension(ending);
    if (std::filesystem::exists(beside)) {
      notes.push_back({beside.filename().string(), "",
                       "beside the case: texts that people typed, as they typed them"});
    }
  }
}

}  // namespace

std::vector<PrivacyNote> privacy_notes(const std::filesystem::path& path) {
  const Bytes bytes = read_file(path, kMostCaseBytes);
  const CaseInfo info = read_case_info(bytes, path.string());  // it is a case
  const std::map<std::string, Bytes> files = read_zip(bytes, path.string());
  const Bytes& text = files.at("meta.json");
  const json meta = json::parse(text.begin(), text.end(), nullptr, false);
  const json& block = meta.at("clipgs");
  std::vector<PrivacyNote> notes;
  note_keys(block, "", kBlockKeys, notes);
  note_keys(block.value("look", json::object()), "look.", kLookKeys, notes);
  note_keys(block.value("section", json::object()), "section.", kSectionKeys, notes);
  note_keys(meta, "meta.json: ", kTopKeys, notes);
  note_files(files, meta, notes);
  note_body(info, notes);
  note_companions(path, notes);
  std::ranges::stable_partition(notes, &PrivacyNote::foreign);  // what should not be there first
  return notes;
}

}  // namespace clipgs
