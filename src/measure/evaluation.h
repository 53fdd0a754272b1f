#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "asset/draw_case.h"
#include "cinema/dataset.h"
#include "measure/metrics.h"

namespace clipgs {

/// Metrics of one picture, or their means; a metric that is not defined there is empty (see
/// metrics.h): no plane or no matter near it, nothing visible, no uncut picture in the dataset.
struct Scores {
  double psnr = 0;
  std::optional<double> psnr_masked;
  double ssim = 0;
  std::optional<double> band_ssim;
  std::optional<Leak> leak;

  std::optional<double> leak_percent() const { return leak ? leak->percent() : std::nullopt; }
};

/// How a picture was cut and what drew its faces.
struct Drawing {
  ClipOperator clip = ClipOperator::kExact;
  FaceSource faces = FaceSource::kSplats;
  bool operator==(const Drawing&) const = default;
};

/// One test picture, drawn in one way.
struct FrameScores {
  size_t frame = 0;  ///< index into Dataset::frames
  Drawing drawing;
  Scores scores;
};

/// One line of the table: the mean of every metric over the pictures of a split where it is
/// defined. A mean PSNR is the mean of the pictures' PSNR, not the PSNR of their mean error. The
/// leak is the pictures' leaked energy together over their truths' energy together: a picture that
/// the cut leaves almost empty has no ratio of its own worth averaging.
struct EvaluationRow {
  Split split = Split::kTestAxis;
  Drawing drawing;
  std::string against = "truth";  ///< what the pictures are compared with
  Scores mean;
  size_t images = 0;
};

/// Of the truth, mean over the pictures of a split.
struct NoiseFloor {
  Split split = Split::kTestAxis;
  double db = 0;
  double masked_db = 0;
};

struct Evaluation {
  size_t splats = 0;
  std::uintmax_t bytes = 0;              ///< size of the scene's file
  std::vector<NoiseFloor> noise_floors;  ///< of the splits that have pictures
  std::vector<EvaluationRow> rows;
  std::vector<FrameScores> frames;  ///< in the order split, frame, drawing
};

struct EvaluationOptions {
  std::vector<ClipOperator> clips = {ClipOperator::kHard, ClipOperator::kSoft,
                                     ClipOperator::kExact};
  /// Empty: the volume, if the case has one, and the splats.
  std::vector<FaceSource> faces;
};

/// A test picture of the dataset, checked against its camera's size. Throws Error.
Image load_truth(const Dataset& dataset, const Frame& frame);

/// The picture of a frame, as the evaluation draws it.
Image draw_frame(const Case& contents, const Frame& frame, const Drawing& drawing);

/// Draws every test picture of the dataset in every way and compares it with the path-traced truth
/// over black. Throws Error for a dataset without test pictures, pictures that are missing or of
/// the wrong size, and a case without the section that is asked for.
Evaluation evaluate(const Case& contents, const Dataset& dataset,
                    const EvaluationOptions& options = {});

/// {"splats", "bytes", "noise_floor_db": {split: dB}, "masked_noise_floor_db": {split: dB}, "rows":
/// [{"split", "clip", "section", "against", "psnr", "psnr_masked", "ssim", "band_ssim", "leak",
/// "images"}]}; null where a metric is not defined.
std::string evaluation_json(const Evaluation& evaluation);

/// The same rows as a table for a terminal.
std::string evaluation_table(const Evaluation& evaluation);

}  // namespace clipgs
