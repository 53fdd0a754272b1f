#include "cinema/denoise.h"

#include <gtest/gtest.h>

#include "cinema/test_scenes.h"
#include "core/parallel.h"
#include "volume/phantom.h"

namespace clipgs {
namespace {

constexpr int kSize = 96;

/// The phantom cut open, with its few samples or with many.
Picture torso(int spp, std::uint64_t seed) {
  static const Volume volume = make_phantom(64);
  static const CinemaScene scene(volume, load_preset("skin-and-bone"));
  const Camera camera = frame_sphere({Vec3(0), 190}, View{30, 20, 1}, kSize, kSize);
  PictureOptions options;
  options.spp = spp;
  options.seed = seed;
  return render_picture(scene, camera, Plane{Vec3(0, -1, 0), 0}, options);
}

double psnr(const Image& a, const Image& b) {
  const Image da = display(a, 1);
  const Image db = display(b, 1);
  double sum = 0;
  for (size_t i = 0; i < da.pixels(); ++i) {
    for (size_t c = 0; c < 3; ++c) {
      const double difference =
          da.data[4 * i + c] * da.data[4 * i + 3] - db.data[4 * i + c] * db.data[4 * i + 3];
      sum += difference * difference;
    }
  }
  return -10 * std::log10(sum / (3.0 * static_cast<double>(da.pixels())));
}

TEST(Denoise, BringsAPictureNearerToTheTruth) {
  const Image truth = torso(512, 1).mean();
  const Picture noisy = torso(4, 2);
  const double before = psnr(noisy.mean(), truth);
  const double after = psnr(denoise(noisy, 1).mean(), truth);
  RecordProperty("before_db", std::to_string(before));
  RecordProperty("after_db", std::to_string(after));
  EXPECT_GT(after, before + 2.5) << before;
}

TEST(Denoise, LeavesACleanPictureAlone) {
  const Picture clean = torso(512, 3);
  EXPECT_GT(psnr(denoise(clean, 1).mean(), clean.mean()), 45);
}

TEST(Denoise, SameBytesAtAnyThreadCount) {
  const Picture noisy = torso(8, 4);
  set_thread_count(1);
  const Picture one = denoise(noisy, 1);
  set_thread_count(2);
  const Picture two = denoise(noisy, 1);
  set_thread_count(0);
  EXPECT_EQ(one.half_a.data, two.half_a.data);
  EXPECT_EQ(one.half_b.data, two.half_b.data);
}

}  // namespace
}  // namespace clipgs
