#include "measure/evaluation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/progress.h"

namespace clipgs {

namespace {

constexpr std::array<Split, 2> kTestSplits = {Split::kTestAxis, Split::kTestOblique};

Image load_picture(const Dataset& dataset, const Frame& frame, const std::string& file) {
  Image image = read_png(dataset.folder / file);
  if (image.width != frame.camera.width || image.height != frame.camera.height) {
    throw Error("{}: is {}×{} pixels, but transforms.json says {}×{}; make the dataset again",
                (dataset.folder / file).string(), image.width, image.height, frame.camera.width,
                frame.camera.height);
  }
  return image;
}

/// First-hit distances in mm, [height, width, 1].
Image load_depth(const Dataset& dataset, const Frame& frame) {
  const Image grey = load_picture(dataset, frame, frame.depth_file);
  Image depth(grey.width, grey.height, 1);
  const float mm = 65535.0f * dataset.depth_scale;
  for (size_t i = 0; i < depth.pixels(); ++i) {
    depth.data[i] = grey.data[i * grey.channels] * mm;
  }
  return depth;
}

/// The truth that the pictures of one frame are compared with.
struct Truth {
  Image picture;
  std::optional<Image> uncut;
  std::optional<Image> depth;
};

Truth load_truths(const Dataset& dataset, const Frame& frame) {
  Truth truth{load_truth(dataset, frame), std::nullopt, std::nullopt};
  if (frame.plane && !frame.uncut_file.empty()) {
    truth.uncut = load_picture(dataset, frame, frame.uncut_file);
  }
  if (frame.plane && !frame.depth_file.empty()) {
    truth.depth = load_depth(dataset, frame);
  }
  return truth;
}

Scores compare(const Truth& truth, const Image& picture, const Frame& frame, float band) {
  const Image map = ssim_map(truth.picture, picture);
  Scores scores;
  scores.psnr = psnr(truth.picture, picture);
  scores.psnr_masked = masked_psnr(truth.picture, picture);
  scores.ssim = mean(map);
  if (frame.plane && truth.depth) {
    scores.band_ssim = band_ssim(map, *truth.depth, frame.camera, *frame.plane, band);
  }
  if (truth.uncut) {
    scores.leak = leak(truth.picture, *truth.uncut, picture);
  }
  return scores;
}

/// Mean of the values that are defined.
class Mean {
 public:
  void add(const std::optional<double>& value) {
    if (value) {
      sum_ += *value;
      ++count_;
    }
  }
  std::optional<double> value() const {
    return count_ > 0 ? std::optional(sum_ / count_) : std::nullopt;
  }

 private:
  double sum_ = 0;
  int count_ = 0;
};

EvaluationRow make_row(const Dataset& dataset, const std::vector<FrameScores>& frames, Split split,
                       const Drawing& drawing) {
  EvaluationRow row;
  row.split = split;
  row.drawing = drawing;
  Mean psnr, psnr_masked, ssim, band_ssim;
  Leak leaks;
  bool any_leak = false;
  for (const FrameScores& frame : frames) {
    if (frame.drawing != drawing || dataset.frames[frame.frame].split != split) {
      continue;
    }
    psnr.add(frame.scores.psnr);
    psnr_masked.add(frame.scores.psnr_masked);
    ssim.add(frame.scores.ssim);
    band_ssim.add(frame.scores.band_ssim);
    if (frame.scores.leak) {
      leaks.add(*frame.scores.leak);
      any_leak = true;
    }
    ++row.images;
  }
  row.mean = {psnr.value().value_or(0), psnr_masked.value(), ssim.value().value_or(0),
              band_ssim.value(), any_leak ? std::optional(leaks) : std::nullopt};
  return row;
}

std::vector<size_t> frames_of(const Dataset& dataset, Split split) {
  std::vector<size_t> frames;
  for (size_t i = 0; i < dataset.frames.size(); ++i) {
    if (dataset.frames[i].split == split) {
      frames.push_back(i);
    }
  }
  return frames;
}

NoiseFloor mean_noise_floor(const Dataset& dataset, Split split,
                            const std::vector<size_t>& frames) {
  NoiseFloor mean{split, 0, 0};
  for (const size_t i : frames) {
    mean.db += dataset.frames[i].noise_db / static_cast<double>(frames.size());
    mean.masked_db += dataset.frames[i].masked_noise_db / static_cast<double>(frames.size());
  }
  return mean;
}

nlohmann::ordered_json number(const std::optional<double>& value) {
  if (!value) {
    return nullptr;
  }
  return std::round(*value * 1e5) / 1e5;
}

std::string cell(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "-";
}

std::vector<Drawing> all_drawings(const Case& contents, const EvaluationOptions& options) {
  std::vector<FaceSource> faces = options.faces;
  if (faces.empty()) {
    faces = contents.section ? std::vector{FaceSource::kVolume, FaceSource::kSplats}
                             : std::vector{FaceSource::kSplats};
  }
  if (!contents.section && std::ranges::find(faces, FaceSource::kVolume) != faces.end()) {
    throw Error("the case has no section volume to draw faces from; use --section splats");
  }
  std::vector<Drawing> drawings;
  for (const FaceSource source : faces) {
    for (const ClipOperator clip : options.clips) {
      drawings.push_back({clip, source});
    }
  }
  return drawings;
}

}  // namespace

Image draw_frame(const Case& contents, const Frame& frame, const Drawing& drawing) {
  return draw_case(contents, frame.camera, frame.plane,
                   {.clip = drawing.clip, .faces = drawing.faces});
}

Image load_truth(const Dataset& dataset, const Frame& frame) {
  return load_picture(dataset, frame, frame.file);
}

Evaluation evaluate(const Case& contents, const Dataset& dataset,
                    const EvaluationOptions& options) {
  const std::vector<Drawing> drawings = all_drawings(contents, options);
  Evaluation evaluation;
  evaluation.splats = contents.scene.gaussians.size();
  std::vector<size_t> tests;
  for (const Split split : kTestSplits) {
    const std::vector<size_t> frames = frames_of(dataset, split);
    if (!frames.empty()) {
      evaluation.noise_floors.push_back(mean_noise_floor(dataset, split, frames));
      tests.insert(tests.end(), frames.begin(), frames.end());
    }
  }
  if (tests.empty()) {
    throw Error("{}: has no test pictures, nothing to compare with; make one with clipgs dataset",
                dataset.folder.string());
  }

  const float band = kBandShare * (dataset.extent.y - dataset.extent.x);
  Progress progress("evaluating", tests.size());
  for (size_t i = 0; i < tests.size(); ++i) {
    const Frame& frame = dataset.frames[tests[i]];
    if (!can_draw(contents, frame.plane)) {
      continue;
    }
    const Truth truth = load_truths(dataset, frame);
    for (const Drawing& drawing : drawings) {
      const Image picture = draw_frame(contents, frame, drawing);
      evaluation.frames.push_back({tests[i], drawing, compare(truth, picture, frame, band)});
    }
    progress.update(i + 1);
  }
  for (const NoiseFloor& noise : evaluation.noise_floors) {
    for (const Drawing& drawing : drawings) {
      evaluation.rows.push_back(make_row(dataset, evaluation.frames, noise.split, drawing));
    }
  }
  return evaluation;
}

std::string evaluation_json(const Evaluation& evaluation) {
  nlohmann::ordered_json json;
  json["splats"] = evaluation.splats;
  json["bytes"] = evaluation.bytes;
  for (const NoiseFloor& noise : evaluation.noise_floors) {
    json["noise_floor_db"][split_name(noise.split)] = number(noise.db);
    json["masked_noise_floor_db"][split_name(noise.split)] = number(noise.masked_db);
  }
  json["rows"] = nlohmann::ordered_json::array();
  for (const EvaluationRow& row : evaluation.rows) {
    json["rows"].push_back({{"split", split_name(row.split)},
                            {"clip", clip_operator_name(row.drawing.clip)},
                            {"section", face_source_name(row.drawing.faces)},
                            {"against", row.against},
                            {"psnr", number(row.mean.psnr)},
                            {"psnr_masked", number(row.mean.psnr_masked)},
                            {"ssim", number(row.mean.ssim)},
                            {"band_ssim", number(row.mean.band_ssim)},
                            {"leak", number(row.mean.leak_percent())},
                            {"images", row.images}});
  }
  return json.dump(2) + "\n";
}

std::string evaluation_table(const Evaluation& evaluation) {
  std::string text = fmt::format("{} splats, {:.2f} MB\n", evaluation.splats,
                                 static_cast<double>(evaluation.bytes) / 1e6);
  text +=
      fmt::format("{:<13} {:<6} {:<8} {:<8} {:>8} {:>8} {:>7} {:>7} {:>9} {:>7}\n", "split", "clip",
                  "section", "against", "PSNR dB", "masked", "SSIM", "band", "leak e-2", "images");
  for (const EvaluationRow& row : evaluation.rows) {
    text += fmt::format("{:<13} {:<6} {:<8} {:<8} {:>8} {:>8} {:>7} {:>7} {:>9} {:>7}\n",
                        split_name(row.split), clip_operator_name(row.drawing.clip),
                        face_source_name(row.drawing.faces), row.against, cell(row.mean.psnr, 2),
                        cell(row.mean.psnr_masked, 2), cell(row.mean.ssim, 4),
                        cell(row.mean.band_ssim, 4), cell(row.mean.leak_percent(), 3), row.images);
  }
  for (const NoiseFloor& noise : evaluation.noise_floors) {
    text += fmt::format(
        "noise floor of {}: {:.1f} dB, masked {:.1f} dB (no PSNR above it can be trusted)\n",
        split_name(noise.split), noise.db, noise.masked_db);
  }
  return text;
}

}  // namespace clipgs
