#include "asset/case.h"

#include <nlohmann/json.hpp>

#include "asset/sog.h"
#include "asset/webp.h"
#include "core/error.h"
#include "core/file.h"
#include "splat/render.h"
#include "splat/scene_file.h"
#include "splat/similarity.h"

namespace clipgs {

using nlohmann::json;

namespace {

constexpr const char* kMetaFile = "meta.json";
constexpr const char* kThumbnailFile = "thumbnail.webp";
constexpr float kThumbnailQuality = 80;
constexpr int kThumbnailSize = 256;
constexpr size_t kMaxMeta = size_t{4} << 20;
constexpr std::uintmax_t kMaxCase = std::uintmax_t{1} << 30;

struct OpenCase {
  std::map<std::string, Bytes> files;
  json meta;
  json block;  // "clipgs" of meta
};

OpenCase open_case(std::span<const std::uint8_t> bytes, const std::string& name) {
  OpenCase result;
  result.files = read_zip(bytes, name);
  const auto meta = result.files.find(kMetaFile);
  if (meta == result.files.end() || meta->second.size() > kMaxMeta) {
    throw Error("{}: has no usable {}; is it a case?", name, kMetaFile);
  }
  result.meta = json::parse(meta->second.begin(), meta->second.end(), nullptr, false);
  if (!result.meta.is_object()) {
    throw Error("{}: its {} is not JSON; the file is corrupt", name, kMetaFile);
  }
  if (!result.meta.contains("clipgs")) {
    throw Error(
        "{}: is a SOG without a \"clipgs\" block, which says how it lies in the patient; "
        "make it with clipgs pack",
        name);
  }
  result.block = result.meta["clipgs"];
  return result;
}

}  // namespace

Bytes encode_case(const Scene& scene, const Image* thumbnail) {
  const Similarity world = scene_to_world();
  json block = scene_to_json(scene, world);
  block["generator"] = "clipgs " CLIPGS_VERSION;
  std::vector<ZipEntry> files;
  json meta = encode_sog(transform(scene.gaussians, world.inverse()), files);
  if (thumbnail != nullptr) {
    files.push_back({kThumbnailFile, encode_webp(*thumbnail, kThumbnailQuality)});
    block["thumbnail"] = kThumbnailFile;
  }
  meta["clipgs"] = std::move(block);
  const std::string text = meta.dump(-1, ' ', false, json::error_handler_t::replace);
  files.push_back({kMetaFile, Bytes(text.begin(), text.end())});
  return write_zip(files);
}

void write_case(const std::filesystem::path& path, const Scene& scene, const Image* thumbnail) {
  const Bytes bytes = encode_case(scene, thumbnail);
  write_file(path, bytes.data(), bytes.size());
}

Scene read_case(std::span<const std::uint8_t> bytes, const std::string& name) {
  const OpenCase opened = open_case(bytes, name);
  Scene scene;
  const Similarity world = scene_from_json(opened.block, name + ": clipgs", scene);
  scene.gaussians = transform(decode_sog(opened.meta, opened.files, name), world);
  return scene;
}

Scene read_case(const std::filesystem::path& path) {
  return read_case(read_file(path, kMaxCase), path.string());
}

Scene load_scene(const std::filesystem::path& path) {
  return path.extension() == ".ply" ? read_scene(path) : read_case(path);
}

Image make_thumbnail(const Scene& scene) {
  const View view{30, 10, 1};
  const Camera camera = frame_sphere(scene.sphere, view, kThumbnailSize, kThumbnailSize);
  return render(scene.gaussians, camera, std::nullopt, ClipOperator::kExact);
}

CaseInfo read_case_info(std::span<const std::uint8_t> bytes, const std::string& name) {
  OpenCase opened = open_case(bytes, name);
  CaseInfo info;
  scene_from_json(opened.block, name + ": clipgs", info.scene);
  info.bytes = bytes.size();
  const SogSummary summary = sog_summary(opened.meta, name);
  info.splats = summary.count;
  info.sh_degree = summary.sh_degree;
  const auto generator = opened.block.find("generator");
  if (generator != opened.block.end() && generator->is_string()) {
    info.generator = generator->get<std::string>();
  }
  const auto thumbnail = opened.block.find("thumbnail");
  if (thumbnail != opened.block.end() && thumbnail->is_string()) {
    const auto file = opened.files.find(thumbnail->get<std::string>());
    if (file != opened.files.end()) {
      info.thumbnail = std::move(file->second);
    }
  }
  return info;
}

CaseInfo read_case_info(const std::filesystem::path& path) {
  return read_case_info(read_file(path, kMaxCase), path.string());
}

}  // namespace clipgs
