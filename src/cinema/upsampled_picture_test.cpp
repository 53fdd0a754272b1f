// Pictures of bodies whose surface is known, as a scanner samples them, against those of the body
// itself: what upsample() is for.

#include <cmath>
#include <gtest/gtest.h>
#include <iostream>
#include <string>

#include "cinema/picture.h"
#include "cinema/scene.h"
#include "cinema/test_scenes.h"
#include "core/image.h"
#include "volume/test_bodies.h"
#include "volume/upsample.h"

namespace clipgs {
namespace {

struct Case {
  const char* name;
  SolidBody body;
  Vec3 spacing;  // mm, of the scan
  double gain;   // dB, at least; measured ones are in docs/tried.md
};

/// Flesh of one colour: what differs is the surface.
Preset flesh() {
  Preset preset = load_preset("soft-tissue");
  const Vec3 color(0.7f, 0.35f, 0.24f);
  preset.transfer =
      TransferFunction({{-300, {color, 0}}, {-200, {color, 2.5f}}, {-150, {color, 4}}});
  return preset;
}

Image draw(const Volume& volume, const Preset& preset) {
  constexpr int kSize = 160;
  const Camera camera = look_at(Vec3(30, 60, 130), Vec3(0, 0, 10), Vec3(0, 1, 0), kSize, kSize);
  PictureOptions options;
  options.spp = 192;
  return display(render_picture(CinemaScene(volume, preset), camera, std::nullopt, options).mean(),
                 preset.display());
}

/// PSNR, dB, of what both show as solid.
double likeness(const Image& a, const Image& b) {
  double squares = 0;
  double count = 0;
  for (size_t p = 0; p < a.pixels(); ++p) {
    const float* const x = &a.data[4 * p];
    const float* const y = &b.data[4 * p];
    if (x[3] > 0.99f && y[3] > 0.99f) {
      for (int c = 0; c < 3; ++c) {
        squares += std::pow(static_cast<double>(x[c] - y[c]), 2);
      }
      count += 3;
    }
  }
  return -10 * std::log10(squares / count);
}

class UpsampledPicture : public testing::TestWithParam<Case> {};

TEST_P(UpsampledPicture, IsNearerToTheBody) {
  const auto& [name, body, spacing, gain] = GetParam();
  const Preset preset = flesh();
  TestScan how;
  how.half_side = 58;
  // The body itself: voxels far finer than the scan's, which keep its lengths (Volume::upsampling).
  const IVec3 finer(glm::round(spacing / 0.5f));
  how.spacing = spacing / Vec3(finer);
  Volume ideal = scan(body, how);
  ideal.upsampling = finer;
  const Image truth = draw(ideal, preset);
  how.spacing = spacing;
  how.noise = 15;
  const Volume scanned = scan(body, how);
  const double before = likeness(draw(scanned, preset), truth);
  const double after = likeness(draw(upsample(scanned, preset.transfer), preset), truth);
  std::cout << name << ": " << before << " -> " << after << " dB\n";
  EXPECT_GT(after, before + gain);
}

INSTANTIATE_TEST_SUITE_P(
    Bodies, UpsampledPicture,
    testing::Values(Case{"Ball3mm", ball(48.3f), Vec3(3), 3},
                    Case{"BallSlices3mm", ball(48.3f), Vec3(0.75f, 0.75f, 3), 7},
                    Case{"Torus3mm", tilted_torus(34.2f, 15.4f), Vec3(3), 2},
                    Case{"TorusSlices3mm", tilted_torus(34.2f, 15.4f), Vec3(0.75f, 0.75f, 3), 5.5},
                    Case{"Face3mm", face_like(), Vec3(3), 2.5},
                    Case{"FaceSlices3mm", face_like(), Vec3(0.75f, 0.75f, 3), 5}),
    [](const auto& body) { return std::string(body.param.name); });

}  // namespace
}  // namespace clipgs
