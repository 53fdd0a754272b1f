#include "cinema/picture.h"

#include <gtest/gtest.h>

#include "cinema/test_scenes.h"
#include "cinema/visible_matter.h"
#include "core/parallel.h"
#include "volume/phantom.h"

namespace clipgs {
namespace {

using test::make_preset;
using test::point;

// A lit ball in soft light.
struct PictureFixture {
  Volume volume = make_ball(32, 12, 1, 0);
  Preset preset = make_preset(
      {point(0, 0, Vec3(0.7f)), point(1, 1, Vec3(0.7f))},
      {Vec3(0.6f), Vec3(0.3f), Vec3(0.1f), {{Vec3(0.6f, 0.8f, 0), Vec3(0.5f), 0.2f}}}, 2);
  CinemaScene scene{volume, preset};
  Camera camera = frame_sphere({Vec3(0), 13}, View{20, 30, 1}, 48, 48);

  Picture render(int spp, float noise_db = 0, std::uint64_t seed = 1,
                 const std::optional<Plane>& plane = std::nullopt) const {
    PictureOptions options;
    options.spp = spp;
    options.noise_db = noise_db;
    options.seed = seed;
    return render_picture(scene, camera, plane, options);
  }
  Image shown(const Picture& picture) const {
    return composite(display(picture.mean(), preset.display()), 0, 0, 0);
  }
};

double mean_squared_error(const Image& a, const Image& b) {
  double sum = 0;
  for (size_t i = 0; i < a.data.size(); ++i) {
    sum += std::pow(a.data[i] - b.data[i], 2);
  }
  return sum / static_cast<double>(a.data.size());
}

TEST(Picture, SameBytesAtAnyThreadCount) {
  const PictureFixture f;
  set_thread_count(1);
  const Picture one = f.render(24);
  set_thread_count(2);
  const Picture two = f.render(24);
  set_thread_count(0);
  EXPECT_EQ(one.half_a.data, two.half_a.data);
  EXPECT_EQ(one.half_b.data, two.half_b.data);
}

TEST(Picture, PlaneThatKeepsEverythingChangesNothing) {
  const PictureFixture f;
  const Picture whole = f.render(16);
  const Picture kept = f.render(16, 0, 1, Plane{Vec3(0, 0, 1), -500});
  const Picture removed = f.render(16, 0, 1, Plane{Vec3(0, 0, 1), 500});
  EXPECT_EQ(whole.half_a.data, kept.half_a.data);
  EXPECT_EQ(whole.half_b.data, kept.half_b.data);
  for (const float x : removed.mean().data) {
    ASSERT_EQ(x, 0);
  }
}

TEST(Picture, NoiseFloorIsTheRealError) {
  const PictureFixture f;
  const Image truth = f.shown(f.render(1200, 0, 99));
  double real = 0;
  double estimated = 0;
  constexpr int kPictures = 4;
  for (std::uint64_t seed = 0; seed < kPictures; ++seed) {
    const Picture picture = f.render(64, 0, seed);
    real += mean_squared_error(f.shown(picture), truth) / kPictures;
    estimated += std::pow(10, -0.1 * noise_floor(picture, f.preset.display())) / kPictures;
  }
  EXPECT_NEAR(10 * std::log10(estimated / real), 0, 0.6);
}

TEST(Picture, SamplesGoOnUntilTheNoiseFloorIsReached) {
  const PictureFixture f;
  const Picture coarse = f.render(100000, 33);
  const Picture fine = f.render(100000, 42);
  EXPECT_GE(noise_floor(coarse, f.preset.display()), 33);
  EXPECT_GE(noise_floor(fine, f.preset.display()), 42);
  EXPECT_LT(noise_floor(fine, f.preset.display()), 44);
  EXPECT_GT(fine.samples, 3 * coarse.samples);
}

TEST(Picture, BudgetIsKept) {
  const PictureFixture f;
  const Picture picture = f.render(40);
  const Image mean = picture.mean();
  double matter = 0;
  for (size_t i = 0; i < mean.pixels(); ++i) {
    matter += mean.data[4 * i + 3] > 0 ? 1 : 0;
  }
  const auto pixels = static_cast<double>(mean.pixels());
  EXPECT_LT(picture.samples, 1.2 * (40 * matter + 8 * (pixels - matter)));
  EXPECT_GT(picture.samples, 0.8 * 40 * matter);
}

// Light of a cut face is known, not sampled: at few samples already no pixel of it stands out, but
// for the edges between tissues, which pixels are sampled across.
TEST(Picture, CutFacesHaveNoSpeckle) {
  const Volume volume = make_phantom(64);
  const Preset preset = load_preset("soft-tissue", volume);
  const CinemaScene scene(volume, preset);
  const VisibleMatter matter = visible_matter(volume, preset.transfer);
  const Plane plane{glm::normalize(Vec3(0.36f, -0.8f, -0.48f)), 0};
  const Camera camera = look_at(-300.0f * plane.normal + matter.sphere.center, matter.sphere.center,
                                Vec3(0, 0, 1), 64, 64);
  const auto shown = [&](int spp) {
    PictureOptions options;
    options.spp = spp;
    return composite(
        display(render_picture(scene, camera, plane, options).mean(), preset.display()), 0, 0, 0);
  };
  const Image few = shown(16);
  const Image many = shown(150);
  const Image depth = render_depth(scene, camera, plane);
  int face = 0;
  int off = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const Vec3 met = camera.position + *depth.at(x, y) * camera.ray_direction(x + 0.5f, y + 0.5f);
      if (*depth.at(x, y) == 0 || std::abs(plane.signed_distance(met)) > 0.5f * volume.spacing.x) {
        continue;
      }
      ++face;
      float difference = 0;
      for (int c = 0; c < 3; ++c) {
        difference = std::max(difference, std::abs(few.at(x, y)[c] - many.at(x, y)[c]));
      }
      off += difference > 0.05f ? 1 : 0;
      EXPECT_LT(difference, 0.2f) << x << " " << y;
    }
  }
  EXPECT_GT(face, 600);
  EXPECT_LT(off, face / 50);
}

TEST(Picture, DisplayKeepsAlphaStraight) {
  Image hdr(2, 1, 4);
  hdr.data = {0.1f, 0.05f, 0, 0.5f, 0, 0, 0, 0};
  const Image image = display(hdr, {2});
  EXPECT_FLOAT_EQ(image.data[0], srgb_from_linear(0.4f));
  EXPECT_FLOAT_EQ(image.data[1], srgb_from_linear(0.2f));
  EXPECT_FLOAT_EQ(image.data[3], 0.5f);
  EXPECT_FLOAT_EQ(image.data[7], 0);
}

TEST(Picture, DisplayFollowsTheToneCurve) {
  Image hdr(1, 1, 4);
  hdr.data = {0.1f, 0.45f, 0.7f, 0.5f};
  const Image image = display(hdr, {2, ToneCurve::kFilmic});
  EXPECT_FLOAT_EQ(image.data[0], display_from_linear(0.4f, ToneCurve::kFilmic));
  EXPECT_LT(image.data[1], image.data[2]);  // by plain sRGB both are white
  EXPECT_LT(image.data[2], 1);
  EXPECT_FLOAT_EQ(image.data[3], 0.5f);
}

TEST(Picture, DepthIsDistanceFromTheCamera) {
  const PictureFixture f;
  const Image depth = render_depth(f.scene, f.camera, std::nullopt);
  EXPECT_NEAR(*depth.at(24, 24), glm::length(f.camera.position) - 12, 1.5f);
  EXPECT_EQ(*depth.at(0, 0), 0);
}

TEST(VisibleMatter, FramesTheBallAndNotTheSpeck) {
  Volume volume = make_ball(80, 15, 1, 0);
  volume.values.unpack()[volume.offset(2, 3, 77)] = 1;
  const TransferFunction transfer({point(0.4f, 0), point(0.6f, 5)});
  const VisibleMatter matter = visible_matter(volume, transfer);
  EXPECT_LT(glm::length(matter.sphere.center), 1.0f);
  EXPECT_GE(matter.sphere.radius, 14.5f);
  EXPECT_LT(matter.sphere.radius, 16.0f);
  EXPECT_NEAR(matter.bounds.max.x, 15, 1);
  const Vec2 extent = matter.extent(Vec3(0, 0, 1));
  EXPECT_NEAR(extent.x, -15, 1);
  EXPECT_NEAR(extent.y, 15, 1);
}

TEST(VisibleMatter, LeavesHiddenLabelsOut) {
  Volume volume = make_ball(80, 15, 1, 0);
  const TransferFunction transfer({point(0.4f, 0), point(0.6f, 5)});
  volume.label_numbers = {0, 9};
  for (size_t i = 0; i < volume.voxels(); ++i) {
    volume.labels.push_back(i < volume.voxels() / 2 ? 1 : 0);  // the inferior half
  }
  EXPECT_NEAR(visible_matter(volume, transfer).bounds.min.z, -15, 1);
  LabelLooks looks;
  looks[9].opacity = 0;
  EXPECT_NEAR(visible_matter(volume, transfer, looks).bounds.min.z, 0.5f, 0.1f);
  looks[0].opacity = 0;
  EXPECT_THROW(visible_matter(volume, transfer, looks), std::runtime_error);
}

TEST(VisibleMatter, NothingToSeeIsAnError) {
  const Volume volume = make_ball(24, 6, 1, 0);
  EXPECT_THROW(visible_matter(volume, TransferFunction({point(2, 0), point(3, 5)})),
               std::runtime_error);
}

}  // namespace
}  // namespace clipgs
