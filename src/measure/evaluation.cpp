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

/// What draws the faces of a subject: as asked for, if it can.
std::vector<FaceSource> face_sources(const Subject& subject, bool first,
                                     const EvaluationOptions& options) {
  const bool has_volume = subject.contents->section.has_value();
  if (options.faces.empty()) {
    return has_volume ? std::vector{FaceSource::kVolume, FaceSource::kSplats}
                      : std::vector{FaceSource::kSplats};
  }
  std::vector<FaceSource> sources = options.faces;
  if (!has_volume && std::erase(sources, FaceSource::kVolume) > 0 && first) {
    throw Error("the case has no section volume to draw faces from; use --section splats");
  }
  return sources;
}

std::vector<Drawing> all_drawings(std::span<const Subject> subjects,
                                  const EvaluationOptions& options) {
  const bool any_model = std::ranges::any_of(
      subjects, [](const Subject& subject) { return subject.contents->model.has_value(); });
  std::vector<Drawing> drawings;
  for (size_t s = 0; s < subjects.size(); ++s) {
    const bool is_model = subjects[s].contents->model.has_value();
    const std::vector<ClipOperator> clips =
        is_model ? std::vector{ClipOperator::kExact} : options.clips;
    for (const FaceSource faces : face_sources(subjects[s], s == 0, options)) {
      for (const ClipOperator clip : clips) {
        drawings.push_back({s, clip, faces});
      }
    }
    if (any_model && !is_model) {
      for (const ClipOperator clip : clips) {
        drawings.push_back({s, clip, FaceSource::kSplats, true});
      }
    }
  }
  return drawings;
}

/// The first subject that is a neural model, or null.
const Case* find_model(std::span<const Subject> subjects) {
  for (const Subject& subject : subjects) {
    if (subject.contents->model) {
      return subject.contents;
    }
  }
  return nullptr;
}

}  // namespace

Image draw_frame(const Case& contents, const Frame& frame, const Drawing& drawing) {
  return draw_case(contents, frame.camera, frame.plane,
                   {.clip = drawing.clip, .faces = drawing.faces});
}

Image load_truth(const Dataset& dataset, const Frame& frame) {
  return load_picture(dataset, frame, frame.file);
}

const char* clip_text(const Evaluation& evaluation, const Drawing& drawing) {
  return evaluation.is_model[drawing.subject] ? "own" : clip_operator_name(drawing.clip);
}

std::string against_text(const Evaluation& evaluation, const Drawing& drawing) {
  if (!drawing.against_model) {
    return "truth";
  }
  const auto model = std::ranges::find(evaluation.is_model, true) - evaluation.is_model.begin();
  return evaluation.subjects[static_cast<size_t>(model)];
}

Evaluation evaluate(std::span<const Subject> subjects, const Dataset& dataset,
                    const EvaluationOptions& options) {
  const std::vector<Drawing> drawings = all_drawings(subjects, options);
  Evaluation evaluation;
  for (const Subject& subject : subjects) {
    evaluation.subjects.push_back(subject.name);
    evaluation.is_model.push_back(subject.contents->model.has_value());
  }
  evaluation.splats = subjects[0].contents->scene.gaussians.size();
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

  const Case* const model = find_model(subjects);
  const float band = kBandShare * (dataset.extent.y - dataset.extent.x);
  Progress progress("evaluating", tests.size());
  for (size_t i = 0; i < tests.size(); ++i) {
    const Frame& frame = dataset.frames[tests[i]];
    const Truth truth = load_truths(dataset, frame);
    const bool model_draws =
        model != nullptr && can_draw(*model, frame.plane, ClipOperator::kExact);
    const Truth of_model{model_draws ? draw_frame(*model, frame, {}) : Image(), std::nullopt,
                         truth.depth};
    for (const Drawing& drawing : drawings) {
      const Case& contents = *subjects[drawing.subject].contents;
      if (!can_draw(contents, frame.plane, drawing.clip) ||
          (drawing.against_model && !model_draws)) {
        continue;
      }
      const Image picture = draw_frame(contents, frame, drawing);
      const Truth& expected = drawing.against_model ? of_model : truth;
      evaluation.frames.push_back({tests[i], drawing, compare(expected, picture, frame, band)});
    }
    progress.update(i + 1);
  }
  for (const NoiseFloor& noise : evaluation.noise_floors) {
    for (const Drawing& drawing : drawings) {
      const EvaluationRow row = make_row(dataset, evaluation.frames, noise.split, drawing);
      if (row.images > 0) {
        evaluation.rows.push_back(row);
      }
    }
  }
  if (evaluation.rows.empty()) {
    throw Error("{}: has no test pictures that layers can draw: none is cut along the axis",
                dataset.folder.string());
  }
  return evaluation;
}

std::string evaluation_json(const Evaluation& evaluation) {
  nlohmann::ordered_json json;
  json["splats"] = evaluation.splats;
  json["bytes"] = evaluation.bytes;
  for (const SizeStage& stage : evaluation.sizes) {
    json["sizes"].push_back({{"stage", stage.name}, {"bytes", stage.bytes}});
  }
  for (const NoiseFloor& noise : evaluation.noise_floors) {
    json["noise_floor_db"][split_name(noise.split)] = number(noise.db);
    json["masked_noise_floor_db"][split_name(noise.split)] = number(noise.masked_db);
  }
  json["rows"] = nlohmann::ordered_json::array();
  for (const EvaluationRow& row : evaluation.rows) {
    json["rows"].push_back({{"subject", evaluation.subjects[row.drawing.subject]},
                            {"split", split_name(row.split)},
                            {"clip", clip_text(evaluation, row.drawing)},
                            {"section", face_source_name(row.drawing.faces)},
                            {"against", against_text(evaluation, row.drawing)},
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
  constexpr const char* kLine =
      "{:<10} {:<13} {:<6} {:<8} {:<8} {:>8} {:>8} {:>7} {:>7} {:>9} {:>7}\n";
  text += fmt::format(kLine, "scene", "split", "clip", "section", "against", "PSNR dB", "masked",
                      "SSIM", "band", "leak e-2", "images");
  for (const EvaluationRow& row : evaluation.rows) {
    text += fmt::format(kLine, evaluation.subjects[row.drawing.subject], split_name(row.split),
                        clip_text(evaluation, row.drawing), face_source_name(row.drawing.faces),
                        against_text(evaluation, row.drawing), cell(row.mean.psnr, 2),
                        cell(row.mean.psnr_masked, 2), cell(row.mean.ssim, 4),
                        cell(row.mean.band_ssim, 4), cell(row.mean.leak_percent(), 3), row.images);
  }
  for (const NoiseFloor& noise : evaluation.noise_floors) {
    text += fmt::format(
        "noise floor of {}: {:.1f} dB, masked {:.1f} dB (no PSNR above it can be trusted)\n",
        split_name(noise.split), noise.db, noise.masked_db);
  }
  for (const SizeStage& stage : evaluation.sizes) {
    text +=
        fmt::format("{:<40} {:>12.2f} MB\n", stage.name, static_cast<double>(stage.bytes) / 1e6);
  }
  return text;
}

}  // namespace clipgs
