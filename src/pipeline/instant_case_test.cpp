#include "pipeline/instant_case.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asset/draw_case.h"
#include "cinema/picture.h"
#include "core/error.h"
#include "core/parallel.h"
#include "measure/metrics.h"
#include "volume/phantom.h"

namespace clipgs {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr int kSize = 64;  // of the phantom, and px

/// A case as a viewer has it: coded and read.
Case read_again(const Case& contents) {
  Case read = read_case(encode_case(contents, nullptr, {.section_quality = 90}), "case.sog");
  prepare_openings(read);
  return read;
}

double masked_psnr_to_truth(const Case& contents, const CinemaScene& scene, const Cut& cut) {
  const Camera camera = frame_sphere(contents.scene.sphere, View{30, 15, 1}, kSize, kSize);
  PictureOptions options;
  options.noise_db = 36;
  options.spp = 512;
  const Image truth =
      display(render_picture(scene, camera, cut, options).mean(), scene.preset().display());
  return masked_error(truth, draw_case(contents, camera, cut)).psnr().value();
}

TEST(InstantCase, ShowsTheVolumeWholeAndCut) {
  const Volume volume = make_phantom(kSize);
  const Preset preset = load_preset("soft-tissue");
  const Case contents = read_again(make_instant_case(volume, preset, {}));
  EXPECT_TRUE(contents.scene.placed);
  EXPECT_EQ(contents.scene.title, "CT, soft tissue");
  EXPECT_EQ(contents.scene.look.volume.size(), 16u);
  const CinemaScene scene(volume, preset);
  EXPECT_GT(masked_psnr_to_truth(contents, scene, Cut()), 27);
  EXPECT_GT(masked_psnr_to_truth(contents, scene, Plane{{0, 0, -1}, 0}), 27);
  EXPECT_GT(masked_psnr_to_truth(contents, scene, Plane{glm::normalize(Vec3(1, 2, -1)), 5}), 27);
}

// Other viewers of splats know nothing of a section.
TEST(InstantCase, SplatsAloneShowTheWholeBody) {
  const Volume volume = make_phantom(kSize);
  const Preset preset = load_preset("soft-tissue");
  Case contents = read_again(make_instant_case(volume, preset, {}));
  contents.section.reset();
  contents.openings.reset();
  EXPECT_GT(masked_psnr_to_truth(contents, CinemaScene(volume, preset), Cut()), 14);
}

TEST(InstantCase, OfGlassIsFilledWithSplats) {
  const Volume volume = make_phantom(kSize);
  for (const bool none : {false, true}) {
    const Preset preset = load_preset(none ? "soft-tissue" : "x-ray");
    InstantOptions options;
    options.section.none = none;
    const Case contents = make_instant_case(volume, preset, options);
    EXPECT_FALSE(contents.scene.placed);
    EXPECT_EQ(contents.section.has_value(), !none);
    EXPECT_GT(contents.scene.gaussians.size(), 30000u);
    const double psnr = masked_psnr_to_truth(contents, CinemaScene(volume, preset), Cut());
    EXPECT_GT(psnr, 15);
  }
}

TEST(InstantCase, HasTheSameBytesAtAnyThreadCount) {
  const Volume volume = make_phantom(48);
  const Preset preset = load_preset("skin-and-bone");
  const auto bytes = [&] {
    return encode_case(make_instant_case(volume, preset, {}), nullptr,
                       {.section_quality = 80, .saving = Saving::kTime});
  };
  const Bytes many = bytes();
  set_thread_count(1);
  const Bytes one = bytes();
  set_thread_count(0);
  EXPECT_EQ(one, many);
}

TEST(InstantCase, SaysWhatCannotBeShown) {
  const Volume volume = make_phantom(48);
  Preset preset = load_preset("soft-tissue");
  EXPECT_THROW(make_instant_case(make_ball(16, 5, -1000, -1000), preset, {}), Error);  // air
  preset.gradient_opacity.emplace();
  EXPECT_THAT([&] { make_instant_case(volume, preset, {}); },
              ThrowsMessage<Error>(HasSubstr("gradient opacity")));
}

}  // namespace
}  // namespace clipgs
