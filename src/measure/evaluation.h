#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "asset/draw_case.h"
#include "cinema/dataset.h"
#include "measure/cut_face.h"
#include "measure/flip.h"
#include "measure/metrics.h"

namespace clipgs {

/// What one class of pixels has of a picture: PSNR, dB, and its shares (0…1) of the masked pixels
/// and of their squared error.
struct ClassShare {
  std::optional<double> psnr;
  std::optional<double> pixels;
  std::optional<double> error;
};

/// Metrics of one picture, or their means; a metric that is not defined there is empty (see
/// metrics.h): no plane or no matter near it, nothing visible, no uncut picture in the dataset.
struct Scores {
  double psnr = 0;
  std::optional<double> psnr_masked;
  double ssim = 0;
  std::optional<double> band_ssim;
  std::optional<double> flip;  ///< mean of flip_map() over the pixels of psnr_masked
  // Energies and errors are summed over pictures: one that shows almost none of a class, or that
  // the cut leaves almost empty, has no figure of its own worth averaging.
  std::optional<Leak> leak;
  SquaredError masked;  ///< what psnr_masked is made of
  std::optional<ClassErrors> classes;
  std::optional<CutFace> cut;  ///< of views that are for it (is_cut_view())

  std::optional<double> leak_percent() const { return leak ? leak->percent() : std::nullopt; }
  ClassShare share(PixelClass which) const;  ///< empty where classes are not known
};

/// What is measured, and what the tables call it.
struct Subject {
  std::string name;
  const Case* contents;
};

/// How a picture was drawn, and what it is held against.
struct Drawing {
  size_t subject = 0;                        ///< index into Evaluation::subjects
  ClipOperator clip = ClipOperator::kExact;  ///< a neural model's own, whatever this says
  FaceSource faces = FaceSource::kSplats;
  bool against_model = false;  ///< held against the neural model's picture, not the truth
  bool operator==(const Drawing&) const = default;
};

/// One test picture, drawn in one way.
struct FrameScores {
  size_t frame = 0;  ///< index into Dataset::frames
  Drawing drawing;
  Scores scores;
};

/// One line of the table: the mean of every metric over the pictures of a split where it is
/// defined, sums where Scores has sums. A mean PSNR is the mean of the pictures' PSNR, not the PSNR
/// of their mean error, which `mean.masked` has.
struct EvaluationRow {
  Split split = Split::kTestAxis;
  Drawing drawing;
  Scores mean;
  /// Half width of the 95 % confidence interval of the mean masked PSNR, dB (Student's t: the
  /// pictures are a sample of all views and planes). Empty for fewer than two pictures.
  std::optional<double> confidence;
  std::optional<size_t> worst;     ///< index into Dataset::frames: the least masked PSNR …
  std::optional<double> worst_db;  ///< … and that
  size_t images = 0;
};

/// Of the truth, mean over the pictures of a split.
struct NoiseFloor {
  Split split = Split::kTestAxis;
  double db = 0;
  double masked_db = 0;
};

/// Bytes of a scene after one step on its way to a case.
struct SizeStage {
  std::string name;
  std::uintmax_t bytes = 0;
};

/// What an evaluation measured.
struct Evaluation {
  std::vector<std::string> subjects;     ///< names; the first is the one that matters
  std::vector<bool> is_model;            ///< of each
  size_t splats = 0;                     ///< of the first
  std::uintmax_t bytes = 0;              ///< size of its file
  std::vector<SizeStage> sizes;          ///< empty if not asked for
  std::vector<NoiseFloor> noise_floors;  ///< of the splits that have pictures
  std::vector<EvaluationRow> rows;
  std::vector<FrameScores> frames;  ///< in the order split, frame, drawing
};

/// What an evaluation measures.
struct EvaluationOptions {
  std::span<const Split> splits = kTestSplits;
  std::vector<ClipOperator> clips = {ClipOperator::kHard, ClipOperator::kSoft,
                                     ClipOperator::kExact};
  /// Empty: the volume, if the case has one, and the splats.
  std::vector<FaceSource> faces;
  float pixels_per_degree = kHeadsetPixelsPerDegree;  ///< that ꟻLIP counts on
};

/// Makes the test and validation pictures of a dataset `size` pixels wide: cameras that see as
/// much, pictures averaged in linear light as they are loaded. Throws Error where that does not
/// divide theirs.
void show_at_size(int size, Dataset& dataset);

/// A test or validation picture of the dataset, checked against its camera's size. Throws Error.
Image load_truth(const Dataset& dataset, const Frame& frame);

/// The picture of a frame, as the evaluation draws it.
Image draw_frame(const Case& contents, const Frame& frame, const Drawing& drawing);

/// Draws every picture of the splits in every way and compares it with the path-traced truth
/// over black. A neural model among the subjects draws the frames that it can, in its own way, and
/// the others are held against its pictures too, faces by splats, as ClipGS-VR's table has it. By
/// layers the frames are drawn that they can draw.
/// Throws Error for a dataset without such pictures, pictures that are missing or of the wrong
/// size, and a first subject without the section that is asked for.
Evaluation evaluate(std::span<const Subject> subjects, const Dataset& dataset,
                    const EvaluationOptions& options = {});

/// What a row says of its pictures: "hard", "soft", "exact" or "layers", or "own" for a neural
/// model …
const char* clip_text(const Evaluation& evaluation, const Drawing& drawing);
/// … and "truth" or the model's name.
std::string against_text(const Evaluation& evaluation, const Drawing& drawing);

/// {"splats", "bytes", "sizes": [{"stage", "bytes"}], "noise_floor_db": {split: dB},
/// "masked_noise_floor_db": {split: dB}, "rows": [{"subject", "split", "clip", "section",
/// "against", SCORES, "psnr_masked_pooled", "psnr_masked_confidence", "psnr_masked_worst", "worst",
/// "images"}], "frames": [{"file", "split", "subject", "clip", "section", "against", SCORES}]};
/// SCORES: "psnr", "psnr_masked", "ssim", "band_ssim", "flip", "leak", "psnr_face", "pixels_face",
/// "error_face" and the same of "opened" and "outside": shares of the masked pixels and of their
/// squared error. null where a metric is not defined.
std::string evaluation_json(const Evaluation& evaluation, const Dataset& dataset);

/// The same rows as tables for a terminal.
std::string evaluation_table(const Evaluation& evaluation, const Dataset& dataset);

}  // namespace clipgs
