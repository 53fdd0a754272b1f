#include "measure/evaluation.h"

#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/error.h"
#include "core/progress.h"
#include "core/random.h"
#include "measure/report.h"
#include "section/test_section.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

constexpr float kRadius = 40;  // mm
constexpr float kDepthScale = 0.01f;

/// A ball of coloured Gaussians.
Scene make_scene() {
  Scene scene;
  scene.gaussians = Gaussians(600, 0);
  Gaussians& g = scene.gaussians;
  Rng rng(7);
  for (size_t i = 0; i < g.size(); ++i) {
    const float radius = kRadius * std::cbrt(rng.uniform());
    const Vec3 mean = radius * fibonacci_sphere(static_cast<int>(i), 600);
    for (int axis = 0; axis < 3; ++axis) {
      g.plane(Gaussians::kMean + axis)[i] = mean[axis];
      g.plane(Gaussians::kLogScale + axis)[i] = std::log(3.0f + 3.0f * rng.uniform());
      g.plane(Gaussians::kSh + axis)[i] = rng.normal();
    }
    g.plane(Gaussians::kRotation)[i] = 1;
    g.plane(Gaussians::kOpacity)[i] = 2;
  }
  scene.sphere = {{0, 0, 0}, kRadius + 5};
  scene.title = "A <ball> & \"more\"";
  return scene;
}

EvaluationOptions only(ClipOperator clip) {
  EvaluationOptions options;
  options.clips = {clip};
  return options;
}

class EvaluationTest : public testing::Test {
 protected:
  EvaluationTest() {
    Progress::set_enabled(false);
    fs::create_directories(folder_);
    dataset_.folder = folder_;
    dataset_.axis = {0, 0, 1};
    dataset_.extent = {-kRadius, kRadius};
    dataset_.sphere = scene_.sphere;
    dataset_.preset = "bone";
    dataset_.depth_scale = kDepthScale;
    for (int i = 0; i < 3; ++i) {
      const float offset = -10.0f + 10.0f * static_cast<float>(i);
      add_frame(Split::kTestAxis, Plane{{0, 0, -1}, offset}, {30.0f * static_cast<float>(i), 40});
      add_frame(Split::kTestOblique, Plane{glm::normalize(Vec3(1, -1, -1)), offset},
                {40.0f * static_cast<float>(i), 20});
    }
  }
  ~EvaluationTest() override { fs::remove_all(folder_); }
  EvaluationTest(const EvaluationTest&) = delete;
  EvaluationTest& operator=(const EvaluationTest&) = delete;

  /// A test picture whose truth is the scene itself under the exact operator.
  void add_frame(Split split, const Plane& plane, const View& view) {
    Frame frame;
    frame.camera = frame_sphere(scene_.sphere, view, 64, 48);
    frame.plane = plane;
    frame.split = split;
    const std::string name = std::to_string(dataset_.frames.size());
    frame.file = name + ".png";
    frame.uncut_file = name + "-uncut.png";
    frame.depth_file = name + "-depth.png";
    frame.noise_db = 41.0f + static_cast<float>(dataset_.frames.size());
    frame.masked_noise_db = frame.noise_db - 6;
    const Image truth = render(scene_.gaussians, frame.camera, plane, ClipOperator::kExact);
    write_png(folder_ / frame.file, truth, 16);
    write_png(folder_ / frame.uncut_file,
              render(scene_.gaussians, frame.camera, std::nullopt, ClipOperator::kExact), 16);
    write_png(folder_ / frame.depth_file, plane_depth(frame.camera, plane, truth), 16);
    frame.uncut_depth_file = name + "-uncut-depth.png";
    write_png(folder_ / frame.uncut_depth_file, Image(64, 48, 1), 16);
    dataset_.frames.push_back(frame);
  }

  /// Distance along each covered pixel's ray to the plane, as the dataset stores it.
  static Image plane_depth(const Camera& camera, const Plane& plane, const Image& truth) {
    Image depth(truth.width, truth.height, 1);
    for (int y = 0; y < truth.height; ++y) {
      for (int x = 0; x < truth.width; ++x) {
        const Vec3 ray =
            camera.ray_direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        const float distance =
            -plane.signed_distance(camera.position) / glm::dot(plane.normal, ray);
        if (truth.at(x, y)[3] > 0.5f && distance > 0) {
          *depth.at(x, y) = distance / kDepthScale / 65535.0f;
        }
      }
    }
    return depth;
  }

  fs::path folder_ =
      fs::path(testing::TempDir()) / ("clipgs-evaluation-" + std::to_string(getpid()));
  Case contents_{make_scene()};
  std::vector<Subject> subjects_{{"ball", &contents_}};
  const Scene& scene_ = contents_.scene;
  Dataset dataset_;
};

TEST_F(EvaluationTest, ShowsPicturesSmaller) {
  const Image own = load_truth(dataset_, dataset_.frames[0]);
  show_at_size(32, dataset_);
  const Frame& frame = dataset_.frames[0];
  EXPECT_EQ(frame.camera.height, 24);
  EXPECT_NEAR(frame.noise_db, 41 + 6.02f, 0.01f);
  const Image smaller = load_truth(dataset_, frame);
  ASSERT_EQ(smaller.width, 32);
  Vec3 light(0);
  float alpha = 0;
  for (const auto& [x, y] : {std::pair(30, 20), {31, 20}, {30, 21}, {31, 21}}) {
    const float* in = own.at(x, y);
    alpha += 0.25f * in[3];
    for (int c = 0; c < 3; ++c) {
      light[c] += 0.25f * in[3] * linear_from_srgb(in[c]);
    }
  }
  EXPECT_NEAR(smaller.at(15, 10)[3], alpha, 1e-5f);
  EXPECT_NEAR(smaller.at(15, 10)[1], srgb_from_linear(light[1] / alpha), 1e-5f);
  // Splats that are blurred by a larger pixel are not quite the mean of smaller ones.
  const Evaluation evaluation = evaluate(subjects_, dataset_, only(ClipOperator::kExact));
  EXPECT_GT(*evaluation.rows[0].mean.psnr_masked, 25);
  EXPECT_LT(*evaluation.rows[0].mean.psnr_masked, 60);
  EXPECT_GT(*evaluation.rows[0].mean.band_ssim, 0.9);
  EXPECT_THROW(show_at_size(30, dataset_), Error);
  EXPECT_THROW(show_at_size(64, dataset_), Error);
}

TEST_F(EvaluationTest, RanksTheOperatorThatMadeTheTruthFirst) {
  const Evaluation evaluation = evaluate(subjects_, dataset_);
  EXPECT_EQ(evaluation.splats, 600u);
  ASSERT_EQ(evaluation.rows.size(), 6u);
  EXPECT_EQ(evaluation.frames.size(), 18u);
  for (size_t split = 0; split < 2; ++split) {
    const EvaluationRow& hard = evaluation.rows[split * 3];
    const EvaluationRow& soft = evaluation.rows[split * 3 + 1];
    const EvaluationRow& exact = evaluation.rows[split * 3 + 2];
    EXPECT_EQ(hard.drawing.clip, ClipOperator::kHard);
    EXPECT_EQ(exact.drawing.clip, ClipOperator::kExact);
    EXPECT_EQ(exact.images, 3u);
    EXPECT_GT(*exact.mean.psnr_masked, 60);
    EXPECT_GT(*exact.mean.psnr_masked, *soft.mean.psnr_masked + 10);
    EXPECT_GT(*exact.mean.psnr_masked, *hard.mean.psnr_masked + 10);
    EXPECT_GT(*exact.mean.band_ssim, 0.999);
    EXPECT_GT(*exact.mean.band_ssim, *hard.mean.band_ssim);
    EXPECT_GT(*hard.mean.leak_percent(), *exact.mean.leak_percent());
    EXPECT_LT(hard.mean.ssim, exact.mean.ssim);
    EXPECT_LT(*exact.mean.flip, 0.01);
    EXPECT_GT(*hard.mean.flip, *exact.mean.flip + 0.05);
  }
  // Frames alternate between the splits with noise floors 41, 42, …, 46.
  ASSERT_EQ(evaluation.noise_floors.size(), 2u);
  EXPECT_EQ(evaluation.noise_floors[0].split, Split::kTestAxis);
  EXPECT_NEAR(evaluation.noise_floors[0].db, 43, 1e-9);
  EXPECT_EQ(evaluation.noise_floors[1].split, Split::kTestOblique);
  EXPECT_NEAR(evaluation.noise_floors[1].masked_db, 38, 1e-9);
}

TEST_F(EvaluationTest, JsonHasTheDocumentedKeys) {
  Evaluation evaluation = evaluate(subjects_, dataset_, only(ClipOperator::kSoft));
  evaluation.bytes = 1234;
  const nlohmann::ordered_json json =
      nlohmann::ordered_json::parse(evaluation_json(evaluation, dataset_));
  EXPECT_EQ(json["splats"], 600);
  EXPECT_EQ(json["bytes"], 1234);
  EXPECT_EQ(json["noise_floor_db"]["test_axis"], 43.0);
  EXPECT_EQ(json["masked_noise_floor_db"]["test_axis"], 37.0);
  ASSERT_EQ(json["rows"].size(), 2u);
  const nlohmann::ordered_json& row = json["rows"][1];
  std::vector<std::string> keys;
  for (const auto& item : row.items()) {
    keys.push_back(item.key());
  }
  EXPECT_THAT(keys, testing::ElementsAre(
                        "subject", "clip", "section", "against", "split", "psnr", "psnr_masked",
                        "ssim", "band_ssim", "flip", "leak", "psnr_face", "pixels_face",
                        "error_face", "psnr_opened", "pixels_opened", "error_opened",
                        "psnr_outside", "pixels_outside", "error_outside", "psnr_masked_pooled",
                        "psnr_masked_confidence", "psnr_masked_worst", "worst", "images"));
  ASSERT_EQ(json["frames"].size(), 6u);
  EXPECT_EQ(json["frames"][0]["file"], "0.png");
  EXPECT_TRUE(json["frames"][0]["psnr_face"].is_number());
  EXPECT_EQ(row["split"], "test_oblique");
  EXPECT_EQ(row["clip"], "soft");
  EXPECT_EQ(row["section"], "splats");
  EXPECT_EQ(row["against"], "truth");
  EXPECT_EQ(row["images"], 3);
  EXPECT_NEAR(row["psnr"], evaluation.rows[1].mean.psnr, 1e-5);
}

TEST_F(EvaluationTest, ARowSumsUpItsPictures) {
  const Evaluation evaluation = evaluate(subjects_, dataset_, only(ClipOperator::kHard));
  const EvaluationRow& row = evaluation.rows[0];
  double sum = 0, squares = 0, error = 0;
  size_t pixels = 0;
  std::pair<double, size_t> worst{kMaxPsnr, 0};
  for (const FrameScores& frame : evaluation.frames) {
    if (dataset_.frames[frame.frame].split != row.split) {
      continue;
    }
    const double db = *frame.scores.psnr_masked;
    sum += db;
    squares += db * db;
    worst = std::min(worst, {db, frame.frame});
    pixels += frame.scores.masked.pixels;
    error += static_cast<double>(frame.scores.masked.pixels) * 3 * std::pow(10, -db / 10);
  }
  const double mean = sum / 3;
  EXPECT_NEAR(*row.mean.psnr_masked, mean, 1e-9);
  // t(0.975; 2) = 4.30265, of a table.
  EXPECT_NEAR(*row.confidence, 4.30265 * std::sqrt((squares - 3 * mean * mean) / 2 / 3), 1e-4);
  EXPECT_EQ(*row.worst, worst.second);
  EXPECT_NEAR(*row.worst_db, worst.first, 1e-12);
  EXPECT_NEAR(*row.mean.masked.psnr(), psnr_from_mse(error / (3.0 * static_cast<double>(pixels))),
              1e-9);
  double shares = 0, errors = 0;
  for (const PixelClass which : kPixelClasses) {
    shares += row.mean.share(which).pixels.value_or(0);
    errors += row.mean.share(which).error.value_or(0);
  }
  EXPECT_NEAR(shares, 1, 1e-12);
  EXPECT_NEAR(errors, 1, 1e-12);
  // The splats' centres alone decide what the hard operator draws: wrong at the face first of all.
  EXPECT_GT(*row.mean.share(PixelClass::kFace).error, *row.mean.share(PixelClass::kFace).pixels);
}

TEST_F(EvaluationTest, ValidationIsASplitOfItsOwn) {
  EvaluationOptions options = only(ClipOperator::kHard);
  options.splits = kValidationSplits;
  EXPECT_THAT([&] { evaluate(subjects_, dataset_, options); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("no pictures of validation_axis")));
  dataset_.frames[1].split = Split::kValidationOblique;
  const Evaluation evaluation = evaluate(subjects_, dataset_, options);
  ASSERT_EQ(evaluation.rows.size(), 1U);
  EXPECT_EQ(evaluation.rows[0].split, Split::kValidationOblique);
  EXPECT_EQ(evaluation.rows[0].images, 1U);
  EXPECT_FALSE(evaluation.rows[0].confidence);
  EXPECT_THAT(evaluation_table(evaluation, dataset_), testing::HasSubstr("validation_oblique"));
}

TEST_F(EvaluationTest, CutViewsAreMeasuredByWhatTheCutDoes) {
  for (Frame& frame : dataset_.frames) {
    frame.split = frame.split == Split::kTestAxis ? Split::kTestCutAxis : Split::kTestCutOblique;
  }
  const auto cut = [&](ClipOperator clip) {
    const Evaluation evaluation = evaluate(subjects_, dataset_, only(clip));
    EXPECT_EQ(evaluation.rows.size(), 2U);
    EXPECT_THAT(evaluation_table(evaluation, dataset_), testing::HasSubstr("edge CDE"));
    const auto json = nlohmann::json::parse(evaluation_json(evaluation, dataset_));
    EXPECT_EQ(json["rows"][0]["cut_face_error"].is_null(),
              !evaluation.rows[0].mean.cut->face.percent());
    return *evaluation.rows[0].mean.cut;
  };
  // The truth is the exact operator's own picture, in 8 bits.
  const CutFace exact = cut(ClipOperator::kExact);
  EXPECT_GT(*exact.ssim(), 0.999);
  EXPECT_LT(*exact.face.percent(), 1);
  const CutFace hard = cut(ClipOperator::kHard);
  EXPECT_LT(*hard.ssim(), *exact.ssim());
  EXPECT_GT(*hard.face.percent(), *exact.face.percent() + 5);
  // Other splits have no such figures.
  dataset_.frames[0].split = Split::kTestAxis;
  const Evaluation evaluation = evaluate(subjects_, dataset_, only(ClipOperator::kExact));
  EXPECT_FALSE(evaluation.rows[0].mean.cut);
}

TEST_F(EvaluationTest, MetricsThatAPictureDoesNotDefineAreNull) {
  for (Frame& frame : dataset_.frames) {
    frame.uncut_file.clear();
    frame.depth_file.clear();
    frame.uncut_depth_file.clear();
  }
  const Evaluation evaluation = evaluate(subjects_, dataset_, only(ClipOperator::kExact));
  const auto json = nlohmann::json::parse(evaluation_json(evaluation, dataset_));
  EXPECT_TRUE(json["rows"][0]["leak"].is_null());
  EXPECT_TRUE(json["rows"][0]["band_ssim"].is_null());
  EXPECT_TRUE(json["rows"][0]["psnr_face"].is_null());
  EXPECT_TRUE(json["rows"][0]["psnr_masked"].is_number());
}

TEST_F(EvaluationTest, ReportIsOneSafeFileWithPictures) {
  const Evaluation evaluation = evaluate(subjects_, dataset_);
  const std::string html = evaluation_report(subjects_, dataset_, evaluation);
  EXPECT_THAT(html, testing::HasSubstr("Not for diagnosis"));
  EXPECT_THAT(html, testing::HasSubstr("A &lt;ball&gt; &amp; &quot;more&quot;"));
  EXPECT_THAT(html, testing::Not(testing::HasSubstr("<ball>")));
  EXPECT_THAT(html, testing::Not(testing::HasSubstr("http")));
  size_t pictures = 0;
  for (size_t at = html.find("data:image/webp"); at != std::string::npos;
       at = html.find("data:image/webp", at + 1)) {
    ++pictures;
  }
  EXPECT_EQ(pictures, 2u * 3 * 5);  // splits × all three × truth, three operators, error
}

TEST_F(EvaluationTest, WithASectionBothSourcesOfFacesAreMeasuredAndShown) {
  EXPECT_THAT([&] { evaluate(subjects_, dataset_, {.faces = {FaceSource::kVolume}}); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("no section")));
  contents_.section = test::ball_section();
  const Evaluation evaluation = evaluate(subjects_, dataset_);
  ASSERT_EQ(evaluation.rows.size(), 12U);
  for (size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(evaluation.rows[i].drawing.faces,
              i % 6 < 3 ? FaceSource::kVolume : FaceSource::kSplats);
  }
  // The truth is the splats' own picture here: the volume's faces are others.
  EXPECT_LT(*evaluation.rows[2].mean.psnr_masked, *evaluation.rows[5].mean.psnr_masked - 10);
  const std::string html = evaluation_report(subjects_, dataset_, evaluation);
  EXPECT_THAT(html, testing::HasSubstr("class=\"volume\">volume"));
  EXPECT_THAT(html, testing::HasSubstr("row zoom"));
}

/// A model whose thresholds are the centres: its pictures are those of the hard operator.
Case model_of(const Scene& scene) {
  Case model{scene};
  model.model.emplace();
  model.model->normal = {0, 0, -1};
  for (size_t i = 0; i < scene.gaussians.size(); ++i) {
    model.model->thresholds.push_back(-scene.gaussians.mean(i).z);
  }
  return model;
}

TEST_F(EvaluationTest, AModelIsMeasuredWhereItCanDrawAndOthersAgainstIt) {
  const Case model = model_of(scene_);
  subjects_.push_back({"neural", &model});
  Evaluation evaluation = evaluate(subjects_, dataset_);
  evaluation.sizes = {{"raw states", 6'000'000}};
  // Axis: three operators against truth, three against the model, the model; oblique: three.
  ASSERT_EQ(evaluation.rows.size(), 10U);
  const auto row = [&](size_t subject, ClipOperator clip, bool against_model) {
    return *std::ranges::find(evaluation.rows,
                              Drawing{subject, clip, FaceSource::kSplats, against_model},
                              &EvaluationRow::drawing);
  };
  EXPECT_GT(row(0, ClipOperator::kHard, true).mean.psnr, 60);
  EXPECT_LT(row(0, ClipOperator::kExact, true).mean.psnr, 50);
  const EvaluationRow own = row(1, ClipOperator::kExact, false);
  EXPECT_EQ(own.images, 3U);
  EXPECT_NEAR(own.mean.psnr, row(0, ClipOperator::kHard, false).mean.psnr, 1e-6);
  EXPECT_STREQ(clip_text(evaluation, own.drawing), "own");
  EXPECT_EQ(against_text(evaluation, row(0, ClipOperator::kHard, true).drawing), "neural");
  const std::string html = evaluation_report(subjects_, dataset_, evaluation);
  EXPECT_THAT(html, testing::HasSubstr("class=\"other\">● neural"));
  EXPECT_THAT(html, testing::HasSubstr("raw states</td><td>6.00"));
  EXPECT_THAT(evaluation_table(evaluation, dataset_), testing::HasSubstr("raw states"));
}

TEST_F(EvaluationTest, ADatasetWithoutTestPicturesIsAnError) {
  std::erase_if(dataset_.frames, [](const Frame&) { return true; });
  EXPECT_THAT([&] { evaluate(subjects_, dataset_); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("no pictures of test_axis")));
}

TEST_F(EvaluationTest, AMissingPictureIsAnError) {
  fs::remove(folder_ / dataset_.frames[2].depth_file);
  EXPECT_THAT([&] { evaluate(subjects_, dataset_); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("2-depth.png")));
}

TEST_F(EvaluationTest, APictureOfTheWrongSizeIsAnError) {
  write_png(folder_ / dataset_.frames[1].file, Image(32, 48, 4));
  EXPECT_THAT([&] { evaluate(subjects_, dataset_); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("32×48")));
}

}  // namespace
}  // namespace clipgs
