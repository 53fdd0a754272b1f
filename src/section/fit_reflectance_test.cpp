#include "section/fit_reflectance.h"

#include <gtest/gtest.h>

#include "cinema/make_dataset.h"
#include "cinema/test_scenes.h"
#include "section/faces.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using test::make_preset;
using test::make_volume;
using test::point;

/// Not opaque within half a voxel: light enters the face and comes out elsewhere.
Preset translucent() {
  LightRig rig;
  rig.sky_top = rig.sky_horizon = rig.sky_bottom = Vec3(0.3f);
  rig.keys = {{glm::normalize(Vec3(-0.5f, 0.7f, 0.5f)), Vec3(0.5f), 0.14f}};
  return make_preset({point(20, 0, Vec3(0.5f, 0.3f, 0.2f)), point(30, 1.6f, Vec3(0.5f, 0.3f, 0.2f)),
                      point(180, 2.4f, Vec3(0.9f, 0.85f, 0.7f))},
                     rig, 0.02f);
}

class FitReflectanceTest : public testing::TestWithParam<ToneCurve> {};
INSTANTIATE_TEST_SUITE_P(Tones, FitReflectanceTest,
                         testing::Values(ToneCurve::kSrgb, ToneCurve::kFilmic),
                         [](const auto& tone) { return tone_name(tone.param); });

TEST_P(FitReflectanceTest, LearnsWhatLightDoesBeneathTheFace) {
  const Volume volume = make_volume(IVec3(32), [](const IVec3& at) {
    const Vec3 p = Vec3(at) - 15.5f;
    return glm::length(p) < 12 ? 100 + 50 * std::sin(0.5f * p.x) * std::cos(0.4f * p.z) : 0.0f;
  });
  Preset preset = translucent();
  preset.tone = GetParam();
  DatasetOptions options;
  options.size = 32;
  options.train_frames = 40;
  options.test_frames = 4;
  options.validation_frames = 0;
  options.train_spp = 24;
  options.test_noise_db = 32;
  options.test_masked_noise_db = 0;
  options.upsample = false;
  options.choose_views = false;  // chosen ones show less of faces, and these pictures are tiny
  const TestFolder folder;
  const Dataset dataset = make_dataset(volume, preset, folder.path() / "dataset", options);

  const Section before = make_section(volume, preset, {64});
  Section section = before;
  const ReflectanceFit fit = fit_reflectance(section, dataset);
  EXPECT_GT(fit.pixels, 1000U);
  EXPECT_GT(fit.psnr_after, fit.psnr_before + 1);

  // And on pictures it was not fitted to.
  const auto error = [&](const Section& of) {
    double sum = 0;
    size_t count = 0;
    for (const Frame* frame : dataset.split(Split::kTestOblique)) {
      const Image truth = dataset.load(*frame);
      const Image faces = draw_faces(of, frame->camera, frame->plane);
      for (size_t i = 0; i < faces.data.size(); i += 4) {
        for (size_t c = 0; c < 3 && faces.data[i + 3] > 0.99f; ++c, ++count) {
          sum += std::pow(faces.data[i + c] - truth.data[i + c], 2);
        }
      }
    }
    return sum / static_cast<double>(count);
  };
  const double learnt = error(section);
  EXPECT_LT(learnt, 0.8 * error(before));
  EXPECT_LT(learnt, 0.0012);

  // Nor does it learn what a few pictures show otherwise.
  const std::vector<const Frame*> frames = dataset.split(Split::kTrain);
  for (size_t i = 0; i < frames.size(); i += 7) {
    Image picture = dataset.load(*frames[i]);
    for (size_t k = 0; k < picture.data.size(); ++k) {
      picture.data[k] = k % 4 == 3 ? picture.data[k] : std::min(1.0f, 2 * picture.data[k]);
    }
    write_png(dataset.folder / frames[i]->file, picture);
  }
  section = before;
  fit_reflectance(section, dataset);
  EXPECT_LT(error(section), 1.2 * learnt);
}

}  // namespace
}  // namespace clipgs
