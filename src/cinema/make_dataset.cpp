#include "cinema/make_dataset.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "cinema/dataset_claim.h"
#include "cinema/denoise.h"
#include "cinema/picture.h"
#include "cinema/seed_points.h"
#include "core/error.h"
#include "core/file.h"
#include "core/json_reader.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/random.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using OrderedJson = nlohmann::ordered_json;

constexpr const char* kStateFile = "progress.json";
constexpr const char* kIndexFile = "transforms.json";
constexpr const char* kPointsFile = "points.ply";
// The uncut pictures only tell where matter would be.
constexpr int kUncutSpp = 16;
// Aim a little above the promised noise floor: the estimate itself is noisy.
constexpr float kNoiseMargin = 0.1f;

/// Noise floors of a picture, over all and masked, dB.
using Noise = std::array<float, 2>;

/// Which pictures are finished, and their noise floors; on disk, so that a killed run goes on. Step
/// removes it where they are pictures of something else.
class State {
 public:
  explicit State(const fs::path& folder) : path_(folder / kStateFile) {
    if (!fs::exists(path_)) {
      return;
    }
    const OrderedJson json = OrderedJson::parse(read_text(path_), nullptr, false);
    const OrderedJson frames =
        json.is_object() ? json.value("frames", OrderedJson::object()) : OrderedJson::object();
    for (const auto& [file, noise] : frames.items()) {
      const bool pair =
          noise.is_array() && noise.size() == 2 && noise[0].is_number() && noise[1].is_number();
      if (pair && fs::exists(folder / file)) {
        noise_[file] = noise.get<Noise>();
      }
    }
  }

  bool has(const Frame& frame) const { return noise_.contains(frame.file); }
  const Noise& noise(const Frame& frame) const { return noise_.at(frame.file); }

  void finish(const Frame& frame, const Noise& noise) {
    noise_[frame.file] = noise;
    write_text(path_, OrderedJson{{"frames", noise_}}.dump());
  }

 private:
  fs::path path_;
  std::map<std::string, Noise> noise_;
};

OrderedJson list_of(const Vec3& v) { return {v.x, v.y, v.z}; }

OrderedJson matrix_of(const Mat4& m) {
  OrderedJson rows = OrderedJson::array();
  for (int r = 0; r < 4; ++r) {
    rows.push_back(
        {plain_zero(m[0][r]), plain_zero(m[1][r]), plain_zero(m[2][r]), plain_zero(m[3][r])});
  }
  return rows;
}

Mat4 world_from_index(const Volume& volume) {
  Mat4 matrix(volume.direction);
  for (int k = 0; k < 3; ++k) {
    matrix[k] *= volume.spacing[k];
  }
  matrix[3] = glm::vec4(volume.origin, 1);
  return matrix;
}

OrderedJson frame_json(const Frame& frame) {
  const Camera& c = frame.camera;
  OrderedJson json = {{"file_path", frame.file},
                      {"fl_x", c.fx},
                      {"fl_y", c.fy},
                      {"cx", c.cx},
                      {"cy", c.cy},
                      {"w", c.width},
                      {"h", c.height},
                      {"transform_matrix", matrix_of(c.opengl_camera_to_world())},
                      {"clip_plane", nullptr},
                      {"split", split_name(frame.split)},
                      {"noise_db", frame.noise_db},
                      {"masked_noise_db", frame.masked_noise_db}};
  if (frame.plane) {
    const Plane& p = *frame.plane;
    json["clip_plane"] = {json_number(p.normal.x), json_number(p.normal.y), json_number(p.normal.z),
                          json_number(p.offset)};
  }
  if (!frame.uncut_file.empty()) {
    json["uncut_file_path"] = frame.uncut_file;
  }
  if (!frame.depth_file.empty()) {
    json["depth_file_path"] = frame.depth_file;
  }
  if (!frame.uncut_depth_file.empty()) {
    json["uncut_depth_file_path"] = frame.uncut_depth_file;
  }
  return json;
}

// Depth as 16-bit grey: value · scale mm, 0 for background.
void write_depth(const fs::path& path, Image depth, float scale) {
  for (float& d : depth.data) {
    d /= scale * 65535.0f;
  }
  write_png(path, depth, 16);
}

void check(const DatasetOptions& options) {
  if (options.size < 16 || options.size > 4096) {
    throw Error("dataset: pictures of {0}x{0} px are out of range; use 16 to 4096", options.size);
  }
  if (options.test_size != 0 && (options.test_size < 16 || options.test_size > 4096)) {
    throw Error("dataset: test pictures of {0}x{0} px are out of range; use 16 to 4096",
                options.test_size);
  }
  if (options.train_frames < 1 || options.test_frames < 0 || options.validation_frames < 0 ||
      options.uncut_frames < 0 || options.close_frames < 0 || options.train_spp < 2 ||
      options.test_spp < 2) {
    throw Error("dataset: needs at least one training frame and two samples a pixel");
  }
  if (!(options.near_share >= 0 && options.near_share <= 1)) {
    throw Error("dataset: a share of {} training frames cannot be nearer; use 0 to 1",
                options.near_share);
  }
  if (std::abs(glm::length(options.axis) - 1.0f) > 1e-4f) {
    throw Error("dataset: the axis must be a unit vector");
  }
}

/// Renders frames that are not there yet.
class Maker {
 public:
  Maker(const Volume& volume, const Preset& preset, fs::path folder, const DatasetOptions& options,
        const VisibleMatter& matter)
      : scene_(volume, preset), folder_(std::move(folder)), options_(options) {
    depth_scale_ =
        2.0f * (framing_distance(matter.sphere.radius) + matter.sphere.radius) / 65535.0f;
  }

  float depth_scale() const { return depth_scale_; }
  const CinemaScene& scene() const { return scene_; }

  // Rough cost of a frame, in quarters of a training frame: for the time left.
  size_t cost(const Frame& frame) const {
    const size_t share = static_cast<size_t>(4 * frame.camera.width) * frame.camera.height /
                         (static_cast<size_t>(options_.size) * options_.size);
    return frame.split == Split::kTrain ? share : (is_cut_view(frame.split) ? 32 : 16) * share;
  }

  /// Writes the frame's pictures, the one that State counts last, and returns its noise floor:
  /// before denoising, since the halves of a denoised picture would claim too high a one.
  Noise make(const Frame& frame, std::uint64_t number) const {
    const bool training = frame.split == Split::kTrain;
    PictureOptions options;
    options.max_bounces = options_.max_bounces;
    options.seed = Rng::mix(options_.seed) + number;
    if (!training) {
      write_depth(folder_ / frame.depth_file, render_depth(scene_, frame.camera, frame.plane),
                  depth_scale_);
      PictureOptions clean = options;
      clean.noise_db = options_.test_noise_db + kNoiseMargin;
      clean.masked_noise_db = options_.test_masked_noise_db + kNoiseMargin;
      clean.spp = options_.test_spp;
      if (frame.plane) {
        options.spp = kUncutSpp;
        write_picture(frame.uncut_file, render_picture(scene_, frame.camera, std::nullopt,
                                                       is_cut_view(frame.split) ? clean : options));
        write_depth(folder_ / frame.uncut_depth_file,
                    render_depth(scene_, frame.camera, std::nullopt), depth_scale_);
      }
      options = clean;
    } else {
      options.spp = options_.train_spp;
    }
    options.features = training && options_.denoise;
    const Picture picture = render_picture(scene_, frame.camera, frame.plane, options);
    write_picture(frame.file,
                  options.features ? denoise(picture, scene_.preset().display()) : picture);
    return {noise_floor(picture, scene_.preset().display()),
            masked_noise_floor(picture, scene_.preset().display())};
  }

 private:
  void write_picture(const std::string& file, const Picture& picture) const {
    write_png(folder_ / file, display(picture.mean(), scene_.preset().display()));
  }

  CinemaScene scene_;
  fs::path folder_;
  DatasetOptions options_;
  float depth_scale_ = 0;
};

void make_pictures(TracedVolume& source, const Preset& preset, const VolumeLook& look,
                   const fs::path& folder, const DatasetOptions& options) {
  const Volume& volume = source.scanned();
  for (const char* name : {"images", "uncut", "depth", "uncut_depth"}) {
    create_folder(folder / name);
    sweep_leftovers(folder / name);
  }
  const VisibleMatter matter = visible_matter(volume, preset.transfer, preset.labels);
  const Maker maker(source.traced(), preset, folder, options, matter);
  std::vector<Frame> frames = options.choose_views ? plan_frames(maker.scene(), matter, options)
                                                   : plan_frames(matter, options);
  aim_close_ups(maker.scene(), options.seed, frames);
  bring_near(options.near_share, options.seed, frames);

  State state(folder);
  size_t total = 0;
  size_t done = 0;
  for (const Frame& frame : frames) {
    total += maker.cost(frame);
    done += state.has(frame) ? maker.cost(frame) : 0;
  }
  Progress progress("dataset", total);
  progress.update(done);
  for (size_t i = 0; i < frames.size(); ++i) {
    Frame& frame = frames[i];
    if (!state.has(frame)) {
      state.finish(frame, maker.make(frame, i));
      done += maker.cost(frame);
      progress.update(done);
    }
    frame.noise_db = state.noise(frame)[0];
    frame.masked_noise_db = state.noise(frame)[1];
  }

  const Vec2 extent = matter.extent(options.axis);
  OrderedJson json = {
      {"camera_model", "OPENCV"},
      {"ply_file_path", kPointsFile},
      {"preset", preset.name},
      {kLookKey, volume_look_json(look)},
      {"train_denoised", options.denoise},
      {"axis", list_of(options.axis)},
      {"extent", {extent.x, extent.y}},
      {"sphere", {{"center", list_of(matter.sphere.center)}, {"radius", matter.sphere.radius}}},
      {"bounds", {{"min", list_of(matter.bounds.min)}, {"max", list_of(matter.bounds.max)}}},
      {"volume",
       {{"dims", {volume.dims.x, volume.dims.y, volume.dims.z}},
        {"spacing", list_of(volume.spacing)},
        {"world_from_index", matrix_of(world_from_index(volume))}}},
      {"depth_scale", maker.depth_scale()},
      {"frames", OrderedJson::array()}};
  if (preset.tone != ToneCurve::kSrgb) {
    json["tone"] = tone_name(preset.tone);
  }
  for (const Frame& frame : frames) {
    json["frames"].push_back(frame_json(frame));
  }
  write_text(folder / kIndexFile, json.dump(1));
}

/// Pictures are kept where only words about them are others now.
void write_look(const fs::path& index, const VolumeLook& look) {
  OrderedJson json = OrderedJson::parse(read_text(index));
  json[kLookKey] = volume_look_json(look);
  write_text(index, json.dump(1));
}

}  // namespace

Dataset make_dataset(const Volume& volume, const Preset& preset, const fs::path& folder,
                     const DatasetOptions& options) {
  TracedVolume traced(volume, preset, options.upsample);
  return make_dataset(traced, preset, folder, options);
}

Dataset make_dataset(TracedVolume& source, const Preset& preset, const fs::path& folder,
                     const DatasetOptions& options) {
  const Volume& volume = source.scanned();
  check(options);
  create_folder(folder);
  require_writable(folder / kIndexFile);
  const DatasetClaims claims = claims_of(volume, preset, options);
  const Step points("seed points", folder / "points", claims.points, {folder / kPointsFile});
  if (!points.done()) {
    save_seed_points(folder / kPointsFile,
                     sample_seed_points(volume, preset, options.seed_points, options.seed));
    points.finish();
  }
  const Step pictures("pictures", folder / "transforms", claims.pictures, {folder / kIndexFile},
                      {folder / kStateFile});
  const VolumeLook look = look_of(claims, volume, preset);
  if (!pictures.done()) {
    make_pictures(source, preset, look, folder, options);
    pictures.finish();
    fs::remove(folder / kStateFile);
  }
  Dataset dataset = load_dataset(folder);
  if (dataset.look != look) {
    write_look(folder / kIndexFile, look);
    dataset.look = look;
  }
  return dataset;
}

}  // namespace clipgs
