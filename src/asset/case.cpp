#include "asset/case.h"

#include <array>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "asset/layers.h"
#include "asset/other_splats.h"
#include "asset/section_codings.h"
#include "asset/sog.h"
#include "asset/webp.h"
#include "core/error.h"
#include "core/file.h"
#include "core/json_reader.h"
#include "core/version.h"
#include "splat/scene_file.h"
#include "splat/similarity.h"
#include "train/model_file.h"

namespace clipgs {

using nlohmann::json;

namespace {

constexpr const char* kMetaFile = "meta.json";
constexpr const char* kSectionKey = "section";
constexpr const char* kStatesKey = "states";
constexpr const char* kThumbnailFile = "thumbnail.webp";
constexpr float kThumbnailQuality = 80;
/// Of the JSON, at most, about, and of the ZIP's directory.
constexpr size_t kMetaBytes = 40'000;
constexpr size_t kDirectoryBytes = 2'000;
/// Layers that take a byte, or more of them do.
constexpr size_t kLayersPerByte = 2;
constexpr size_t kMaxMeta = size_t{4} << 20;
constexpr std::uintmax_t kMaxCase = std::uintmax_t{1} << 30;

struct OpenCase {
  std::map<std::string, Bytes> files;
  json meta;
  json block;  // "clipgs" of meta
};

/// Of the files of a ZIP, or at least its meta.json.
OpenCase open_case(std::map<std::string, Bytes> files, const std::string& name) {
  OpenCase result;
  result.files = std::move(files);
  const auto meta = result.files.find(kMetaFile);
  if (meta == result.files.end() || meta->second.size() > kMaxMeta) {
    throw Error("{}: has no usable {}; is it a case?", name, kMetaFile);
  }
  result.meta = json::parse(meta->second.begin(), meta->second.end(), nullptr, false);
  if (!result.meta.is_object()) {
    throw Error("{}: its {} is not JSON; the file is corrupt", name, kMetaFile);
  }
  result.block = result.meta.value("clipgs", json());
  return result;
}

bool has_layers(const json& block) {
  const auto states = block.find(kStatesKey);
  return states != block.end() && states->contains("file");
}

std::string text_of(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string section_name(const std::string& name) { return name + ": clipgs.section"; }

/// Throws Error for a SOG of other programs.
void require_block(const OpenCase& opened, const std::string& name) {
  if (opened.block.is_null()) {
    throw Error(
        "{}: is a SOG without a \"clipgs\" block, which says how it lies in the patient; "
        "make it with clipgs pack",
        name);
  }
}

/// Everything but its size and its thumbnail. `sizes`: of the case's files.
CaseInfo info_of(const OpenCase& opened, const std::map<std::string, size_t>& sizes,
                 const std::string& name) {
  require_block(opened, name);
  CaseInfo info;
  scene_from_json(opened.block, name + ": clipgs", info.scene);
  const SogSummary summary = sog_summary(opened.meta, name);
  info.splats = summary.count;
  info.sh_degree = summary.sh_degree;
  info.has_face_colors = summary.face_colors;
  info.has_layers = has_layers(opened.block);
  if (const auto section = opened.block.find(kSectionKey); section != opened.block.end()) {
    try {
      info.section = section_info(*section, sizes, section_name(name));
    } catch (const Error& error) {
      info.section_problem = error.what();
    }
  }
  const auto generator = opened.block.find("generator");
  if (generator != opened.block.end() && generator->is_string()) {
    info.generator = generator->get<std::string>();
  }
  return info;
}

template <typename Read>
std::optional<Section> read_or_leave_out(BrokenSection broken, const Read& read) {
  try {
    return read();
  } catch (const Error& error) {
    if (broken == BrokenSection::kRefused) {
      throw;
    }
    warn(fmt::format("{} (drawn by its splats alone, hollow where it is cut)", error.what()));
    return std::nullopt;
  }
}

/// Name of the thumbnail's file, or nothing.
std::string thumbnail_file(const OpenCase& opened) {
  const auto thumbnail = opened.block.find("thumbnail");
  const bool named = thumbnail != opened.block.end() && thumbnail->is_string();
  return named ? thumbnail->get<std::string>() : std::string();
}

}  // namespace

Bytes encode_case(const Case& contents, const Image* thumbnail, const CaseCoding& coding) {
  if (contents.model) {
    throw Error("a case holds a scene, not a neural model; make one of it with clipgs bake");
  }
  const Similarity world = scene_to_world();
  const Scene& scene = contents.scene;
  json block = scene_to_json(scene, world);
  block["generator"] = fmt::format("clipgs {}", program_version());
  std::optional<SectionCodings> section;
  if (contents.section) {
    section.emplace(*contents.section, coding.section_quality, coding.saving);
  }
  ZipEntry picture;
  if (thumbnail != nullptr) {
    picture = {kThumbnailFile, encode_webp(*thumbnail, kThumbnailQuality)};
  }
  // Where the size of the case decides, the section is kept as well as fits beside the fewest
  // colours, and the splats have what it leaves.
  const size_t others = kMetaBytes + scene.layers.size() / kLayersPerByte + picture.bytes.size();
  const auto room = [&](size_t least) {
    const size_t rest = coding.bytes - std::min(coding.bytes, others);
    return section ? rest - std::min(rest, section->best(rest - std::min(rest, least)).bytes())
                   : rest;
  };
  std::vector<ZipEntry> files;
  std::vector<size_t> order;
  json meta = encode_sog(transform(scene.gaussians, world.inverse()), files, &order, room);
  if (!scene.layers.empty()) {
    block[kStatesKey]["file"] = encode_layers(scene, order, files, meta);
  }
  if (thumbnail != nullptr) {
    block["thumbnail"] = kThumbnailFile;
  }
  if (section) {
    const size_t rest = picture.bytes.size() + total_bytes(files) + text_of(meta).size() +
                        text_of(block).size() + kDirectoryBytes;
    CodedSection coded = section->best(coding.bytes - std::min(coding.bytes, rest));
    block[kSectionKey] = std::move(coded.block);
    files.push_back(std::move(coded.file));
  }
  meta["clipgs"].update(block);
  const std::string text = text_of(meta);
  // What a viewer shows first is what comes first: the picture, then the splats, then the section.
  files.insert(files.begin(), {kMetaFile, Bytes(text.begin(), text.end())});
  if (thumbnail != nullptr) {
    files.insert(files.begin(), std::move(picture));
  }
  return write_zip(files);
}

void write_case(const std::filesystem::path& path, const Case& contents, const Image* thumbnail,
                const CaseCoding& coding) {
  const Bytes bytes = encode_case(contents, thumbnail, coding);
  write_file(path, bytes.data(), bytes.size());
}

Case read_case(std::span<const std::uint8_t> bytes, const std::string& name, BrokenSection broken) {
  const OpenCase opened = open_case(read_zip(bytes, name), name);
  if (opened.block.is_null()) {
    warn_of_assumptions(name);
    return Case(scene_of_splats(decode_sog(opened.meta, opened.files, name)));
  }
  Case result;
  const Similarity world = scene_from_json(opened.block, name + ": clipgs", result.scene);
  result.scene.gaussians = transform(decode_sog(opened.meta, opened.files, name), world);
  if (has_layers(opened.block)) {
    result.scene.layers =
        decode_layers(JsonReader(opened.block, name).child(kStatesKey).text("file"), opened.files,
                      opened.meta, result.scene, name);
  }
  if (const auto section = opened.block.find(kSectionKey); section != opened.block.end()) {
    result.section = read_or_leave_out(
        broken, [&] { return decode_section(*section, opened.files, section_name(name)); });
  }
  return result;
}

Case read_case(const std::filesystem::path& path, BrokenSection broken) {
  return read_case(read_file(path, kMaxCase), path.string(), broken);
}

void prepare_openings(Case& contents) {
  if (contents.section && !contents.openings) {
    contents.openings = std::make_shared<const Openings>(*contents.section);
  }
}

void relight(Case& contents, const LightRig& rig) {
  const auto is_near = [](const KeyLight& key) { return key.distance > 0; };
  if (rig.environment || std::ranges::any_of(rig.keys, is_near)) {
    throw Error(
        "a panorama, or a lamp at a finite \"distance\", cannot light a case; choose another");
  }
  if (!contents.section) {
    throw Error("a case without a section volume keeps the light that it was made in");
  }
  auto openings = std::make_shared<Openings>(*contents.section);
  if (!openings->drawn()) {
    throw Error("a case of translucent matter keeps the light that it was made in");
  }
  openings->set_rig(rig);
  contents.section->rig = rig;
  contents.openings = std::move(openings);
}

Case load_case(const std::filesystem::path& path, BrokenSection broken) {
  if (is_other_splats(path)) {
    return Case(read_other_splats(path));
  }
  if (path.extension() != ".ply") {
    return read_case(path, broken);
  }
  Case result;
  if (is_model(path)) {
    UniaxialModel model = read_model(path);
    result = Case(std::move(model.scene));
    result.model = std::move(model.parameters);
  } else {
    result = Case(read_scene(path));
  }
  const std::filesystem::path section = section_path(path);
  if (std::filesystem::exists(section)) {
    result.section = read_or_leave_out(broken, [&] { return read_section(section); });
  }
  return result;
}

CaseInfo read_case_info(std::span<const std::uint8_t> bytes, const std::string& name) {
  OpenCase opened = open_case(read_zip(bytes, name), name);
  std::map<std::string, size_t> sizes;
  for (const auto& [file, content] : opened.files) {
    sizes.emplace(file, content.size());
  }
  CaseInfo info = info_of(opened, sizes, name);
  info.bytes = bytes.size();
  if (const auto file = opened.files.find(thumbnail_file(opened)); file != opened.files.end()) {
    info.thumbnail = std::move(file->second);
  }
  return info;
}

CaseInfo read_case_info(const std::filesystem::path& path) {
  return read_case_info(read_file(path, kMaxCase), path.string());
}

CaseInfo read_case_summary(const ByteSource& source, const std::string& name) {
  if (source.size > kMaxCase) {
    throw Error(
        "{}: is {} bytes long, more than the {} that a case may have; is it the right file?", name,
        source.size, kMaxCase);
  }
  const std::map<std::string, size_t> sizes = list_zip(source, name);
  const OpenCase opened = open_case(read_zip(source, name, {kMetaFile}), name);
  CaseInfo info = info_of(opened, sizes, name);
  info.bytes = source.size;
  const std::string thumbnail = thumbnail_file(opened);
  if (sizes.contains(thumbnail)) {
    info.thumbnail = std::move(read_zip(source, name, {thumbnail}).at(thumbnail));
  }
  return info;
}

}  // namespace clipgs
