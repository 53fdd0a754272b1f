#include "measure/evaluation.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/error.h"
#include "core/progress.h"

namespace clipgs {

namespace {

/// A first hit this near to a plane lies on it, in mean voxels: matter whose median depth is looked
/// for begins up to a voxel below its face.
constexpr float kFaceTolerance = 1.5f;

/// A file as it is, checked against its camera's size.
Image load_file(const Dataset& dataset, const Frame& frame, const std::string& file) {
  Image image = read_png(dataset.folder / file);
  const int width = frame.shrink * frame.camera.width;
  const int height = frame.shrink * frame.camera.height;
  if (image.width != width || image.height != height) {
    throw Error("{}: is {}×{} pixels, but transforms.json says {}×{}; make the dataset again",
                (dataset.folder / file).string(), image.width, image.height, width, height);
  }
  return image;
}

/// The mean light of `factor` × `factor` pixels each, of straight alpha.
Image averaged(const Image& image, int factor, ToneCurve tone) {
  Image out(image.width / factor, image.height / factor, image.channels);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      Vec3 light(0);
      float alpha = 0;
      for (int i = 0; i < factor * factor; ++i) {
        const float* in = image.at(factor * x + i % factor, factor * y + i / factor);
        const float a = image.channels == 4 ? in[3] : 1;
        for (int c = 0; c < 3; ++c) {
          light[c] += a * linear_from_display(in[c], tone);
        }
        alpha += a;
      }
      float* to = out.at(x, y);
      for (int c = 0; c < 3; ++c) {
        to[c] = alpha > 0 ? display_from_linear(light[c] / alpha, tone) : 0;
      }
      if (image.channels == 4) {
        to[3] = alpha / static_cast<float>(factor * factor);
      }
    }
  }
  return out;
}

Image load_picture(const Dataset& dataset, const Frame& frame, const std::string& file) {
  Image image = load_file(dataset, frame, file);
  return frame.shrink == 1 ? std::move(image) : averaged(image, frame.shrink, dataset.tone);
}

/// First-hit distances in mm, [height, width, 1].
Image load_depth(const Dataset& dataset, const Frame& frame, const std::string& file) {
  const Image grey = load_file(dataset, frame, file);
  Image depth(frame.camera.width, frame.camera.height, 1);
  const float mm = 65535.0f * dataset.depth_scale;
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) {
      const int middle = frame.shrink / 2;  // of the pixels that are one here
      *depth.at(x, y) = *grey.at(frame.shrink * x + middle, frame.shrink * y + middle) * mm;
    }
  }
  return depth;
}

/// The truth that the pictures of one frame are compared with.
struct Truth {
  Image picture;
  std::optional<Image> uncut;
  std::optional<Image> depth;
  std::vector<PixelClass> classes;  ///< empty if not known
};

Truth load_truths(const Dataset& dataset, const Frame& frame) {
  Truth truth{load_truth(dataset, frame), std::nullopt, std::nullopt, {}};
  if (frame.plane && !frame.uncut_file.empty()) {
    truth.uncut = load_picture(dataset, frame, frame.uncut_file);
  }
  if (!frame.depth_file.empty()) {
    truth.depth = load_depth(dataset, frame, frame.depth_file);
  }
  const bool knows_uncut = !frame.plane || !frame.uncut_depth_file.empty();
  if (truth.depth && knows_uncut) {
    const FirstHits hits{
        *truth.depth, frame.plane ? load_depth(dataset, frame, frame.uncut_depth_file) : Image()};
    truth.classes = classify_pixels(hits, frame.camera, frame.plane, dataset.ends,
                                    kFaceTolerance * dataset.voxel_mm);
  }
  return truth;
}

Scores compare(const Truth& truth, const Image& picture, const Frame& frame, float band,
               float pixels_per_degree) {
  const Image map = ssim_map(truth.picture, picture);
  Scores scores;
  scores.psnr = psnr(truth.picture, picture);
  scores.masked = masked_error(truth.picture, picture);
  scores.psnr_masked = scores.masked.psnr();
  scores.ssim = mean(map);
  scores.flip =
      masked_mean(flip_map(truth.picture, picture, pixels_per_degree), truth.picture, picture);
  if (frame.plane && truth.depth) {
    scores.band_ssim = band_ssim(map, *truth.depth, frame.camera, *frame.plane, band);
  }
  if (truth.uncut) {
    scores.leak = leak(truth.picture, *truth.uncut, picture);
  }
  if (!truth.classes.empty()) {
    scores.classes = masked_errors(truth.picture, picture, truth.classes);
  }
  return scores;
}

/// Mean of the values that are defined.
class Mean {
 public:
  void add(const std::optional<double>& value) {
    if (value) {
      values_.push_back(*value);
    }
  }
  std::optional<double> value() const {
    return values_.empty() ? std::nullopt
                           : std::optional(std::accumulate(values_.begin(), values_.end(), 0.0) /
                                           static_cast<double>(values_.size()));
  }
  /// Half width of its 95 % confidence interval.
  std::optional<double> confidence() const {
    if (values_.size() < 2) {
      return std::nullopt;
    }
    const auto count = static_cast<double>(values_.size());
    double squares = 0;
    for (const double v : values_) {
      squares += (v - *value()) * (v - *value());
    }
    const double quantile =
        boost::math::quantile(boost::math::students_t_distribution<double>(count - 1), 0.975);
    return quantile * std::sqrt(squares / (count - 1) / count);
  }

 private:
  std::vector<double> values_;
};

/// Adds what is summed over pictures.
template <typename Sum>
void add_to(std::optional<Sum>& sum, const std::optional<Sum>& other, const auto& add) {
  if (other) {
    sum = sum.value_or(Sum{});
    add(*sum, *other);
  }
}

EvaluationRow make_row(const Dataset& dataset, const std::vector<FrameScores>& frames, Split split,
                       const Drawing& drawing) {
  EvaluationRow row;
  row.split = split;
  row.drawing = drawing;
  Mean psnr, psnr_masked, ssim, band_ssim, flip;
  for (const FrameScores& frame : frames) {
    if (frame.drawing != drawing || dataset.frames[frame.frame].split != split) {
      continue;
    }
    const Scores& scores = frame.scores;
    psnr.add(scores.psnr);
    psnr_masked.add(scores.psnr_masked);
    ssim.add(scores.ssim);
    band_ssim.add(scores.band_ssim);
    flip.add(scores.flip);
    row.mean.masked.add(scores.masked);
    add_to(row.mean.leak, scores.leak, [](Leak& sum, const Leak& one) { sum.add(one); });
    add_to(row.mean.cut, scores.cut, [](CutFace& sum, const CutFace& one) { sum.add(one); });
    add_to(row.mean.classes, scores.classes, [](ClassErrors& sum, const ClassErrors& one) {
      for (size_t i = 0; i < sum.size(); ++i) {
        sum[i].add(one[i]);
      }
    });
    if (scores.psnr_masked && (!row.worst || *scores.psnr_masked < *row.worst_db)) {
      row.worst = frame.frame;
      row.worst_db = scores.psnr_masked;
    }
    ++row.images;
  }
  row.mean.psnr = psnr.value().value_or(0);
  row.mean.psnr_masked = psnr_masked.value();
  row.mean.ssim = ssim.value().value_or(0);
  row.mean.band_ssim = band_ssim.value();
  row.mean.flip = flip.value();
  row.confidence = psnr_masked.confidence();
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

ClassShare Scores::share(PixelClass which) const {
  if (!classes) {
    return {};
  }
  const SquaredError& own = (*classes)[static_cast<size_t>(which)];
  const auto share = [](double part, double whole) {
    return whole > 0 ? std::optional(part / whole) : std::nullopt;
  };
  return {own.psnr(), share(static_cast<double>(own.pixels), static_cast<double>(masked.pixels)),
          share(own.sum, masked.sum)};
}

Image draw_frame(const Case& contents, const Frame& frame, const Drawing& drawing) {
  return draw_case(contents, frame.camera, frame.plane,
                   {.clip = drawing.clip, .faces = drawing.faces});
}

void show_at_size(int size, Dataset& dataset) {
  for (Frame& frame : dataset.frames) {
    Camera& camera = frame.camera;
    if (frame.split == Split::kTrain) {
      continue;
    }
    const int factor = camera.width / size;
    if (factor < 1 || factor * size != camera.width || camera.height % factor != 0) {
      throw Error("{}: is {} pixels wide, and cannot be shown at {}; use a size that divides it",
                  (dataset.folder / frame.file).string(), camera.width, size);
    }
    camera = shrunk(camera, factor);
    frame.shrink = factor;
    // Pixels' noise is independent.
    const float quieter = 20 * std::log10(static_cast<float>(factor));
    frame.noise_db += quieter;
    frame.masked_noise_db += quieter;
  }
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
  for (const Split split : options.splits) {
    const std::vector<size_t> frames = frames_of(dataset, split);
    if (!frames.empty()) {
      evaluation.noise_floors.push_back(mean_noise_floor(dataset, split, frames));
      tests.insert(tests.end(), frames.begin(), frames.end());
    }
  }
  if (tests.empty()) {
    throw Error("{}: has no pictures of {}, nothing to compare with; make some with clipgs dataset",
                dataset.folder.string(), split_name(options.splits.front()));
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
                         truth.depth, truth.classes};
    for (const Drawing& drawing : drawings) {
      const Case& contents = *subjects[drawing.subject].contents;
      if (!can_draw(contents, frame.plane, drawing.clip) ||
          (drawing.against_model && !model_draws)) {
        continue;
      }
      const Image picture = draw_frame(contents, frame, drawing);
      const Truth& expected = drawing.against_model ? of_model : truth;
      evaluation.frames.push_back(
          {tests[i], drawing, compare(expected, picture, frame, band, options.pixels_per_degree)});
      if (is_cut_view(frame.split) && expected.uncut) {
        Frame uncut = frame;
        uncut.plane.reset();
        evaluation.frames.back().scores.cut =
            cut_face({expected.picture, *expected.uncut, picture,
                      draw_frame(contents, uncut, drawing), frame.camera, *frame.plane},
                     dataset.sphere);
      }
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
    throw Error("{}: has no pictures that layers can draw: none is cut along the axis",
                dataset.folder.string());
  }
  return evaluation;
}

namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson drawing_json(const Evaluation& evaluation, const Drawing& drawing) {
  return {{"subject", evaluation.subjects[drawing.subject]},
          {"clip", clip_text(evaluation, drawing)},
          {"section", face_source_name(drawing.faces)},
          {"against", against_text(evaluation, drawing)}};
}

void add_scores(const Scores& scores, OrderedJson& json) {
  json["psnr"] = number(scores.psnr);
  json["psnr_masked"] = number(scores.psnr_masked);
  json["ssim"] = number(scores.ssim);
  json["band_ssim"] = number(scores.band_ssim);
  json["flip"] = number(scores.flip);
  json["leak"] = number(scores.leak_percent());
  if (scores.cut) {
    json["cut_face_ssim"] = number(scores.cut->ssim());
    json["cut_leak"] = number(scores.cut->leak_percent());
    json["cut_edge_error"] = number(scores.cut->edge.percent());
    json["cut_face_error"] = number(scores.cut->face.percent());
  }
  for (const PixelClass which : kPixelClasses) {
    const std::string name = pixel_class_name(which);
    const ClassShare share = scores.share(which);
    json["psnr_" + name] = number(share.psnr);
    json["pixels_" + name] = number(share.pixels);
    json["error_" + name] = number(share.error);
  }
}

OrderedJson row_json(const Evaluation& evaluation, const Dataset& dataset,
                     const EvaluationRow& row) {
  OrderedJson json = drawing_json(evaluation, row.drawing);
  json["split"] = split_name(row.split);
  add_scores(row.mean, json);
  json["psnr_masked_pooled"] = number(row.mean.masked.psnr());
  json["psnr_masked_confidence"] = number(row.confidence);
  json["psnr_masked_worst"] = number(row.worst_db);
  json["worst"] = row.worst ? OrderedJson(dataset.frames[*row.worst].file) : OrderedJson();
  json["images"] = row.images;
  return json;
}

}  // namespace

std::string evaluation_json(const Evaluation& evaluation, const Dataset& dataset) {
  OrderedJson json;
  json["splats"] = evaluation.splats;
  json["bytes"] = evaluation.bytes;
  for (const SizeStage& stage : evaluation.sizes) {
    json["sizes"].push_back({{"stage", stage.name}, {"bytes", stage.bytes}});
  }
  for (const NoiseFloor& noise : evaluation.noise_floors) {
    json["noise_floor_db"][split_name(noise.split)] = number(noise.db);
    json["masked_noise_floor_db"][split_name(noise.split)] = number(noise.masked_db);
  }
  json["rows"] = OrderedJson::array();
  for (const EvaluationRow& row : evaluation.rows) {
    json["rows"].push_back(row_json(evaluation, dataset, row));
  }
  for (const FrameScores& frame : evaluation.frames) {
    OrderedJson one = {{"file", dataset.frames[frame.frame].file},
                       {"split", split_name(dataset.frames[frame.frame].split)}};
    one.update(drawing_json(evaluation, frame.drawing));
    add_scores(frame.scores, one);
    json["frames"].push_back(std::move(one));
  }
  return json.dump(2) + "\n";
}

std::string evaluation_table(const Evaluation& evaluation, const Dataset& dataset) {
  std::string text = fmt::format("{} splats, {:.2f} MB\n", evaluation.splats,
                                 static_cast<double>(evaluation.bytes) / 1e6);
  constexpr const char* kWay = "{:<10} {:<18} {:<6} {:<8} {:<8}";
  constexpr const char* kLine = " {:>8} {:>8} {:>7} {:>7} {:>7} {:>9} {:>7}\n";
  const auto way = [&](const EvaluationRow& row) {
    return fmt::format(kWay, evaluation.subjects[row.drawing.subject], split_name(row.split),
                       clip_text(evaluation, row.drawing), face_source_name(row.drawing.faces),
                       against_text(evaluation, row.drawing));
  };
  const std::string title = fmt::format(kWay, "scene", "split", "clip", "section", "against");
  text +=
      title + fmt::format(kLine, "PSNR dB", "masked", "SSIM", "band", "FLIP", "leak e-2", "images");
  for (const EvaluationRow& row : evaluation.rows) {
    text += way(row) + fmt::format(kLine, cell(row.mean.psnr, 2), cell(row.mean.psnr_masked, 2),
                                   cell(row.mean.ssim, 4), cell(row.mean.band_ssim, 4),
                                   cell(row.mean.flip, 4), cell(row.mean.leak_percent(), 3),
                                   row.images);
  }
  constexpr const char* kMasked = " {:>6} {:>5} {:>6} {:>6} {:>16} {:>16} {:>16}\n";
  text += "\nmasked PSNR, and of what pixels show (dB, share of pixels, of squared error)\n" +
          title + fmt::format(kMasked, "mean", "±", "pooled", "worst", "face", "opened", "outside");
  for (const EvaluationRow& row : evaluation.rows) {
    const auto share = [&](PixelClass which) {
      const ClassShare one = row.mean.share(which);
      return one.psnr ? fmt::format("{:.2f} {:>4.1f}% {:>4.1f}%", *one.psnr, 100 * *one.pixels,
                                    100 * *one.error)
                      : "-";
    };
    text += way(row) + fmt::format(kMasked, cell(row.mean.psnr_masked, 2), cell(row.confidence, 2),
                                   cell(row.mean.masked.psnr(), 2), cell(row.worst_db, 2),
                                   share(PixelClass::kFace), share(PixelClass::kOpened),
                                   share(PixelClass::kOutside));
  }
  if (std::ranges::any_of(evaluation.rows,
                          [](const EvaluationRow& row) { return row.mean.cut.has_value(); })) {
    constexpr const char* kCut = " {:>10} {:>9} {:>9} {:>9}\n";
    text += "\ncuts as XClipGS measures them (errors and leak e-2)\n" + title +
            fmt::format(kCut, "face SSIM", "leak", "edge CDE", "face CDE");
    for (const EvaluationRow& row : evaluation.rows) {
      if (const std::optional<CutFace>& cut = row.mean.cut) {
        text += way(row) + fmt::format(kCut, cell(cut->ssim(), 3), cell(cut->leak_percent(), 3),
                                       cell(cut->edge.percent(), 2), cell(cut->face.percent(), 2));
      }
    }
  }
  if (!evaluation.rows.empty() && evaluation.rows.front().worst) {
    text += fmt::format("worst of the first row: {}\n",
                        dataset.frames[*evaluation.rows.front().worst].file);
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
