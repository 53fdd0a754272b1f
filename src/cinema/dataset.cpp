#include "cinema/dataset.h"

#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <ranges>

#include "core/camera_file.h"
#include "core/error.h"
#include "core/file.h"
#include "core/json_reader.h"
#include "volume/volume.h"

namespace clipgs {
namespace {

using Json = nlohmann::json;

constexpr size_t kMostFrames = 1'000'000;
constexpr const char* kRemedy = "make the dataset again";

// A path inside the dataset's folder.
std::string read_file(const JsonReader& reader, const char* key) {
  const std::filesystem::path path = reader.text(key);
  bool inside = !path.empty() && path.is_relative();
  for (const std::filesystem::path& part : path) {
    inside = inside && part != "..";
  }
  if (!inside) {
    reader.fail(key, "a path inside the dataset's folder");
  }
  return path.string();
}

Plane read_plane(const JsonReader& reader, const char* key) {
  constexpr float kTolerance = 1e-3f;  // of the normal's length
  const glm::vec4 p = reader.vector<4>(key);
  const Plane plane{Vec3(p), p.w};
  if (std::abs(glm::length(plane.normal) - 1) > kTolerance) {
    reader.fail(key, "a unit normal and an offset");
  }
  return plane;
}

/// Absent in datasets of plain sRGB.
ToneCurve read_tone(const JsonReader& reader) {
  const std::optional<ToneCurve> tone =
      reader.has("tone") ? tone_of_name(reader.text("tone")) : ToneCurve::kSrgb;
  if (!tone) {
    reader.fail("tone", ("one of " + tone_names()).c_str());
  }
  return *tone;
}

/// The sides of the box that voxels' centres span.
std::vector<Plane> read_ends(const JsonReader& volume) {
  const glm::dmat4 world_from_index = volume.matrix("world_from_index");
  const Vec3 dims = volume.vector<3>("dims");
  std::vector<Plane> ends;
  for (int k = 0; k < 3; ++k) {
    const Vec3 step(world_from_index[k]);
    if (!(glm::length(step) > 0)) {
      volume.fail("world_from_index", "an invertible matrix");
    }
    const Vec3 normal = glm::normalize(step);
    const Vec3 first(world_from_index[3]);
    const Vec3 last = first + (dims[k] - 1) * step;
    ends.push_back({normal, glm::dot(normal, first)});
    ends.push_back({-normal, -glm::dot(normal, last)});
  }
  return ends;
}

Split read_split(const JsonReader& reader) {
  const std::string name = reader.text("split");
  for (const Split split : kSplits) {
    if (name == split_name(split)) {
      return split;
    }
  }
  reader.fail("split",
              fmt::format("one of {}", fmt::join(kSplits | std::views::transform(split_name), ", "))
                  .c_str());
}

Frame read_frame(const JsonReader& reader) {
  Frame frame;
  frame.camera = read_camera(reader);
  if (reader.has("clip_plane")) {
    frame.plane = read_plane(reader, "clip_plane");
  }
  frame.split = read_split(reader);
  frame.file = read_file(reader, "file_path");
  if (reader.has("uncut_file_path")) {
    frame.uncut_file = read_file(reader, "uncut_file_path");
  }
  if (reader.has("depth_file_path")) {
    frame.depth_file = read_file(reader, "depth_file_path");
  }
  if (reader.has("uncut_depth_file_path")) {
    frame.uncut_depth_file = read_file(reader, "uncut_depth_file_path");
  }
  frame.noise_db = reader.number("noise_db");
  frame.masked_noise_db = reader.number("masked_noise_db");
  return frame;
}

}  // namespace

const char* split_name(Split split) {
  switch (split) {
    case Split::kTrain:
      return "train";
    case Split::kTestAxis:
      return "test_axis";
    case Split::kTestOblique:
      return "test_oblique";
    case Split::kTestUncut:
      return "test_uncut";
    case Split::kTestClose:
      return "test_close";
    case Split::kTestCutAxis:
      return "test_cut_axis";
    case Split::kTestCutOblique:
      return "test_cut_oblique";
    case Split::kValidationAxis:
      return "validation_axis";
    case Split::kValidationOblique:
      return "validation_oblique";
    case Split::kValidationUncut:
      return "validation_uncut";
    case Split::kValidationClose:
      return "validation_close";
  }
  return "";
}

std::vector<const Frame*> Dataset::split(Split which) const {
  std::vector<const Frame*> chosen;
  for (const Frame& frame : frames) {
    if (frame.split == which) {
      chosen.push_back(&frame);
    }
  }
  return chosen;
}

Image Dataset::load(const Frame& frame) const {
  const std::filesystem::path path = folder / frame.file;
  Image image = read_png(path);
  if (image.width != frame.camera.width || image.height != frame.camera.height ||
      image.channels != 4) {
    throw Error("{}: {}x{} pixels of {} channels, but transforms.json says {}x{} of 4",
                path.string(), image.width, image.height, image.channels, frame.camera.width,
                frame.camera.height);
  }
  return image;
}

Dataset load_dataset(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "transforms.json";
  if (!std::filesystem::exists(path)) {
    throw Error(
        "{}: no dataset here (no transforms.json); make one with 'clipgs dataset VOLUME -o {}'",
        folder.string(), folder.string());
  }
  const Json json = Json::parse(read_text(path), nullptr, false);
  if (json.is_discarded()) {
    throw Error("{}: not valid JSON; make the dataset again", path.string());
  }
  const JsonReader top(json, path.string(), kRemedy);
  Dataset dataset;
  dataset.folder = folder;
  dataset.axis = top.unit_vector("axis");
  dataset.extent = top.vector<2>("extent");
  const JsonReader sphere = top.child("sphere");
  dataset.sphere = {sphere.vector<3>("center"), sphere.number("radius")};
  const JsonReader bounds = top.child("bounds");
  dataset.bounds.min = bounds.vector<3>("min");
  dataset.bounds.max = bounds.vector<3>("max");
  const JsonReader volume = top.child("volume");
  dataset.voxel_mm = mean_spacing(volume.vector<3>("spacing"));
  dataset.ends = read_ends(volume);
  dataset.preset = top.text("preset");
  dataset.look = read_volume_look(top);
  dataset.tone = read_tone(top);
  dataset.depth_scale = top.number("depth_scale");
  if (!(dataset.extent.x < dataset.extent.y) || !(dataset.sphere.radius > 0) ||
      !(dataset.voxel_mm > 0)) {
    throw Error("{}: extent, sphere or spacing is empty; make the dataset again", path.string());
  }
  for (const JsonReader& frame : top.children("frames", kMostFrames)) {
    dataset.frames.push_back(read_frame(frame));
  }
  if (dataset.frames.empty()) {
    top.fail("frames", "a list of frames");
  }
  return dataset;
}

}  // namespace clipgs
