#include "splat/rasterizer.h"

#include <cmath>
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "core/error.h"
#include "core/parallel.h"
#include "core/random.h"
#include "splat/behind.h"
#include "splat/clip.h"
#include "splat/reference.h"

namespace clipgs {
namespace {

/// A cloud that fills the frame, with splats cut by, kept by and removed by the plane.
Gaussians random_cloud(size_t count, int degree, std::uint64_t seed) {
  Gaussians gaussians(count, degree, true);
  Rng rng(seed);
  for (size_t i = 0; i < count; ++i) {
    for (int a = 0; a < 3; ++a) {
      gaussians.plane(Gaussians::kMean + a)[i] = 60 * (rng.uniform() - 0.5f);
      gaussians.plane(Gaussians::kLogScale + a)[i] = std::log(2.0f + 6.0f * rng.uniform());
    }
    for (int a = 0; a < 4; ++a) {
      gaussians.plane(Gaussians::kRotation + a)[i] = 1.7f * rng.normal();
    }
    gaussians.plane(Gaussians::kOpacity)[i] = 2 * rng.normal();
    for (int p = Gaussians::kSh; p < gaussians.planes(); ++p) {
      gaussians.plane(p)[i] = 0.4f * rng.normal();
    }
  }
  return gaussians;
}

Camera test_camera(int width, int height) {
  return frame_sphere({{0, 0, 0}, 45}, View{35, 20, 1.2f}, width, height);
}

const Plane kPlane{glm::normalize(Vec3(0.3f, 0.5f, -0.8f)), 1.5f};

std::vector<double> as_doubles(const Gaussians& g) { return {g.data().begin(), g.data().end()}; }

/// Something in front of the splats, that covers pixels more or less, and some in full.
Image random_front(const Camera& camera, std::uint64_t seed) {
  Image front(camera.width, camera.height, 4);
  Rng rng(seed);
  for (size_t i = 0; i < front.data.size(); i += 4) {
    const float alpha = std::clamp(1.6f * rng.uniform() - 0.3f, 0.0f, 1.0f);
    for (size_t c = 0; c < 3; ++c) {
      front.data[i + c] = alpha * rng.uniform();
    }
    front.data[i + 3] = alpha;
  }
  return front;
}

class ClipTest : public testing::TestWithParam<ClipOperator> {};

TEST_P(ClipTest, FastPictureEqualsReference) {
  const Gaussians cloud = random_cloud(400, 3, 1);
  const Camera camera = test_camera(75, 50);  // not whole tiles
  for (const bool cut : {false, true}) {
    const std::optional<Plane> plane = cut ? std::optional(kPlane) : std::nullopt;
    RasterOptions options;
    options.clip = GetParam();
    Rasterizer rasterizer;
    const Image& fast = rasterizer.forward(cloud, camera, plane, options);
    const std::vector<double> slow =
        reference_render(as_doubles(cloud), cloud, camera, plane, options);
    double worst = 0;
    double total = 0;
    for (size_t i = 0; i < slow.size(); ++i) {
      worst = std::max(worst, std::abs(fast.data[i] - slow[i]));
      total += std::abs(fast.data[i] - slow[i]);
    }
    // A contribution just at 1/255 may fall on either side.
    EXPECT_LT(worst, 1.5 / 255);
    EXPECT_LT(total / static_cast<double>(slow.size()), 2e-5);
  }
}

// Hundreds of times as long as they are thick: what is left of their covariance's determinant is
// blur.
TEST_P(ClipTest, NeedlesEqualTheReference) {
  RasterOptions options;
  options.clip = GetParam();
  Gaussians needles(6, 0);
  Rng rng(3);
  for (size_t i = 0; i < needles.size(); ++i) {
    for (int a = 0; a < 3; ++a) {
      needles.plane(Gaussians::kMean + a)[i] = 2 * (rng.uniform() - 0.5f);
      needles.plane(Gaussians::kLogScale + a)[i] = std::log(a == 0 ? 150.0f : 0.001f);
      needles.plane(Gaussians::kSh + a)[i] = rng.normal();
    }
    for (int a = 0; a < 4; ++a) {
      needles.plane(Gaussians::kRotation + a)[i] = rng.normal();
    }
    needles.plane(Gaussians::kOpacity)[i] = 1;
  }
  const Camera camera = frame_sphere({{0, 0, 0}, 45}, View{35, 20, 14}, 64, 64);
  const Plane far{Vec3(0, 0, 1), -500};
  const Image image = Rasterizer().forward(needles, camera, far, options);
  const std::vector<double> expected =
      reference_render(as_doubles(needles), needles, camera, far, options);
  for (size_t i = 0; i < expected.size(); ++i) {
    ASSERT_NEAR(image.data[i], expected[i], 0.002) << i;
  }
}

TEST_P(ClipTest, SeveralPlanesEqualTheReference) {
  const Gaussians cloud = random_cloud(300, 1, 9);
  const Camera camera = test_camera(64, 48);
  const Plane other{glm::normalize(Vec3(-0.6f, 0.4f, 0.2f)), -6};
  const Plane back{-kPlane.normal, -kPlane.offset - 4};  // a slab of 4 mm, thinner than most
  for (const std::vector<Plane>& planes :
       {std::vector{kPlane, other}, std::vector{kPlane, back}, std::vector{kPlane, other, back}}) {
    RasterOptions options;
    options.clip = GetParam();
    options.kept_share = true;
    const Cut cut(planes);
    EXPECT_FALSE(KeptShare(camera, cut, cloud).is_whole());
    Rasterizer rasterizer;
    const Image& fast = rasterizer.forward(cloud, camera, cut, options);
    const std::vector<double> slow =
        reference_render(as_doubles(cloud), cloud, camera, cut, options);
    double total = 0;
    double light = 0;
    for (size_t i = 0; i < slow.size(); ++i) {
      ASSERT_NEAR(fast.data[i], slow[i], 1.5 / 255);
      total += std::abs(fast.data[i] - slow[i]);
      light += slow[i];
    }
    EXPECT_GT(light, 1);
    EXPECT_LT(total / static_cast<double>(slow.size()), 2e-5);
    Gaussians gradients = cloud;
    EXPECT_THROW(rasterizer.backward(cloud, Image(fast), gradients), Error);
  }
}

TEST_P(ClipTest, SplatsLieBehindWhatIsInFront) {
  const Gaussians cloud = random_cloud(400, 1, 5);
  const Camera camera = test_camera(75, 50);
  RasterOptions options;
  options.clip = GetParam();
  const Image front = random_front(camera, 6);
  const Image alone = Rasterizer().forward(cloud, camera, kPlane, options);
  const Image behind = Rasterizer().forward(cloud, camera, kPlane, options, &front);
  for (size_t i = 0; i < front.data.size(); i += 4) {
    const float face = front.data[i + 3];
    const float splats = alone.data[i + 3];
    ASSERT_NEAR(behind.data[i + 3], std::max(face, splats), 1e-3f);
    const float seen = splats > face ? (splats - face) / splats : 0;
    for (size_t c = 0; c < 3; ++c) {
      ASSERT_NEAR(behind.data[i + c], front.data[i + c] + seen * alone.data[i + c], 2e-3f);
    }
  }
}

TEST_P(ClipTest, EveryInstructionSetDrawsTheSame) {
  const Gaussians cloud = random_cloud(300, 1, 2);
  const Camera camera = test_camera(64, 64);
  RasterOptions options;
  options.clip = GetParam();
  const Image best = Rasterizer().forward(cloud, camera, kPlane, options);
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    const Image other = Rasterizer().forward(cloud, camera, kPlane, options);
    for (size_t i = 0; i < best.data.size(); ++i) {
      ASSERT_NEAR(best.data[i], other.data[i], 1.5f / 255) << hwy::TargetName(target);
    }
  }
  hwy::SetSupportedTargetsForTest(0);
}

/// Loss = Σ weight·image with fixed random weights: its gradient exercises every output.
FaceGain random_gain() {
  FaceGain gain;
  Rng rng(12);
  for (Vec3& coefficient : gain.coefficients) {
    coefficient = 0.2f * Vec3(rng.normal(), rng.normal(), rng.normal());
  }
  return gain;
}

TEST_P(ClipTest, GradientsOfEveryParameterMatchFiniteDifferences) {
  constexpr int kDegree = 3;
  const Gaussians cloud = random_cloud(14, kDegree, 3);
  const Camera camera = test_camera(40, 36);
  // No step to differentiate across: every contribution counts, every Gaussian is cut.
  RasterOptions options;
  options.clip = GetParam();
  options.alpha_min = 1e-7f;
  options.alpha_max = 0.9999f;
  options.transmittance_min = 0;
  options.clip_sigma = 8;
  options.face_gain = random_gain();
  options.kept_share = true;
  Rng rng(4);
  Image weight(camera.width, camera.height, 4);
  for (float& w : weight.data) {
    w = rng.uniform() - 0.3f;
  }
  const Image front = random_front(camera, 5);
  EXPECT_FALSE(KeptShare(camera, kPlane, cloud).is_whole());
  Rasterizer rasterizer;
  rasterizer.forward(cloud, camera, kPlane, options, &front);
  Gaussians gradients = cloud.like(cloud.size());
  rasterizer.backward(cloud, weight, gradients);

  std::vector<double> parameters = as_doubles(cloud);
  const auto loss = [&] {
    std::vector<double> image = reference_render(parameters, cloud, camera, kPlane, options);
    double sum = 0;
    for (size_t i = 0; i < image.size(); i += 4) {
      if (front.data[i + 3] < kOpaqueFace) {
        put_behind(&front.data[i], &image[i], &image[i]);
        for (size_t c = 0; c < 4; ++c) {
          sum += image[i + c] * weight.data[i + c];
        }
      }
    }
    return sum;
  };
  for (int plane = 0; plane < cloud.planes(); ++plane) {
    double largest = 0;
    double worst = 0;
    for (size_t i = 0; i < cloud.size(); ++i) {
      double& p = parameters[static_cast<size_t>(plane) * cloud.size() + i];
      const double saved = p;
      constexpr double kStep = 1e-5;
      p = saved + kStep;
      const double above = loss();
      p = saved - kStep;
      const double below = loss();
      p = saved;
      const double expected = (above - below) / (2 * kStep);
      largest = std::max(largest, std::abs(expected));
      worst = std::max(worst, std::abs(expected - gradients.plane(plane)[i]));
    }
    EXPECT_GT(largest, 0) << "plane " << plane;
    EXPECT_LT(worst, 2e-3 * largest + 1e-4) << "plane " << plane << " largest " << largest;
  }

  // The gain itself, through one of its coefficients: ∂L/∂c = ∂L/∂g·g·Y.
  std::array<float, FaceGain::kCoefficients> basis;
  sh_basis(FaceGain::kDegree, kPlane.normal, basis.data());
  for (int c = 0; c < 3; ++c) {
    const auto at = [&](float coefficient) {
      options.face_gain.coefficients[2][c] = coefficient;
      return loss();
    };
    constexpr float kStep = 1e-3f;
    const float middle = options.face_gain.coefficients[2][c];
    const double expected = (at(middle + kStep) - at(middle - kStep)) / (2 * kStep);
    at(middle);
    const double got =
        rasterizer.gain_gradient()[c] * options.face_gain.at(kPlane.normal)[c] * basis[2];
    EXPECT_NEAR(got, expected, 5e-3 * std::abs(expected) + 1e-3);
    EXPECT_GT(std::abs(expected), 1e-2);
  }
}

TEST(Rasterizer, AFaceIsSeenFromTheRemovedSideAlone) {
  const Gaussians cloud = random_cloud(200, 1, 8);
  ASSERT_TRUE(cloud.has_face_colors());
  const Gaussians plain = cloud.reshaped(1, false);
  RasterOptions options;
  options.clip = ClipOperator::kExact;
  const Plane plane{{0, 0, -1}, 0};  // keeps what is below
  Rasterizer rasterizer;
  for (const float elevation : {40.0f, -40.0f}) {
    const Camera camera = frame_sphere({{0, 0, 0}, 45}, View{10, elevation, 1}, 64, 64);
    const Image with = rasterizer.forward(cloud, camera, plane, options);
    const Image without = rasterizer.forward(plain, camera, plane, options);
    if (elevation > 0) {
      EXPECT_NE(with.data, without.data);
    } else {
      EXPECT_EQ(with.data, without.data);
    }
  }
}

TEST(Rasterizer, OnlyGaussiansThatReachAPixelHaveAGradient) {
  // Along the view: three opaque ones, one hidden behind them, and one on the removed side.
  Gaussians cloud(5, 0);
  const Camera camera = frame_sphere({{0, 0, 0}, 45}, View{0, 0, 1}, 64, 64);
  const Vec3 away = glm::normalize(-camera.position);
  const float along[] = {-10, -5, 0, 20, -30};
  for (size_t i = 0; i < cloud.size(); ++i) {
    for (int a = 0; a < 3; ++a) {
      cloud.plane(Gaussians::kMean + a)[i] = along[i] * away[a];
      cloud.plane(Gaussians::kLogScale + a)[i] = i < 3 ? 3.0f : 0.0f;
    }
    cloud.plane(Gaussians::kRotation)[i] = 1;
    cloud.plane(Gaussians::kOpacity)[i] = 10;
  }
  RasterOptions options;
  options.clip = ClipOperator::kHard;
  Rasterizer rasterizer;
  Image weight = rasterizer.forward(cloud, camera, Plane{away, -20}, options);
  Gaussians gradients(cloud.size(), 0);
  constexpr float kUntouched = 123;
  gradients.plane(Gaussians::kOpacity)[3] = kUntouched;
  gradients.plane(Gaussians::kOpacity)[4] = kUntouched;
  rasterizer.backward(cloud, weight, gradients);
  EXPECT_EQ(rasterizer.reached(), (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(gradients.plane(Gaussians::kOpacity)[3], kUntouched);
  EXPECT_EQ(gradients.plane(Gaussians::kOpacity)[4], kUntouched);
}

TEST_P(ClipTest, SameBytesAtOneAndTwoThreads) {
  const Gaussians cloud = random_cloud(20000, 1, 5);
  const Camera camera = test_camera(160, 144);
  RasterOptions options;
  options.clip = GetParam();
  std::vector<float> images[2];
  std::vector<float> gradients[2];
  for (int threads = 1; threads <= 2; ++threads) {
    set_thread_count(threads);
    Rasterizer rasterizer;
    const Image image = rasterizer.forward(cloud, camera, kPlane, options);
    Gaussians g = cloud.like(cloud.size());
    rasterizer.backward(cloud, image, g);
    images[threads - 1] = image.data;
    gradients[threads - 1] = g.data();
  }
  set_thread_count(0);
  EXPECT_EQ(images[0], images[1]);
  EXPECT_EQ(gradients[0], gradients[1]);
}

TEST_P(ClipTest, PlaneFarAwayCutsNothingOrEverything) {
  const Gaussians cloud = random_cloud(200, 0, 6);
  const Camera camera = test_camera(48, 48);
  RasterOptions options;
  options.clip = GetParam();
  const Image uncut = Rasterizer().forward(cloud, camera, std::nullopt, options);
  const Image kept = Rasterizer().forward(cloud, camera, Plane{{0, 0, 1}, -1000}, options);
  const Image removed = Rasterizer().forward(cloud, camera, Plane{{0, 0, 1}, 1000}, options);
  EXPECT_EQ(uncut.data, kept.data);
  for (const float v : removed.data) {
    EXPECT_EQ(v, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Operators, ClipTest,
                         testing::Values(ClipOperator::kHard, ClipOperator::kSoft,
                                         ClipOperator::kExact),
                         [](const auto& test) {
                           return std::string(clip_operator_name(test.param));
                         });

/// Φ by the error function: what the approximations are held to.
double phi(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

constexpr double kPhiError = 1.5e-4;  // that method.md §3 claims

TEST(ExactClip, PhiOfEveryRendererIsThatOfTheErrorFunction) {
  // One large Gaussian, and planes across it that are seen from the side and aslant: what they
  // leave of its α is Φ(z), at standardised distances z from pixel to pixel.
  Gaussians one(1, 0);
  const Vec3 deviations(9, 4, 6);
  for (int a = 0; a < 3; ++a) {
    one.plane(Gaussians::kLogScale + a)[0] = std::log(deviations[a]);
  }
  one.plane(Gaussians::kRotation)[0] = 1;
  const Camera camera = frame_sphere({{0, 0, 0}, 30}, View{20, 10, 1}, 96, 96);
  RasterOptions options;
  options.alpha_min = 1e-6f;
  options.clip_sigma = 8;
  const auto check = [&](const Plane& plane, const auto& picture, const auto& uncut, double error,
                         Vec2& range) {
    Splat splat;
    const LitPlane lit{plane, Vec3(1)};
    ASSERT_TRUE(project(one, 0, camera, std::span(&lit, 1), options, splat, nullptr));
    ASSERT_EQ(splat.clipped, 1U);
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const size_t at = (static_cast<size_t>(y) * camera.width + x) * 4 + 3;
        if (uncut[at] < 0.05) {
          continue;
        }
        const double z = splat.z0 + splat.zx * (x + 0.5 - splat.x) + splat.zy * (y + 0.5 - splat.y);
        ASSERT_NEAR(picture[at] / uncut[at], phi(z), error) << "z " << z;
        range = {std::min(range.x, static_cast<float>(z)),
                 std::max(range.y, static_cast<float>(z))};
      }
    }
  };
  const std::vector<double> p = as_doubles(one);
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    Vec2 range(0);
    for (const Vec3& normal : {Vec3(0.3f, 0.5f, -0.8f), Vec3(1, 0, 0), Vec3(0.2f, -1, 0.4f)}) {
      for (const float offset : {-4.0f, 0.0f, 3.0f}) {
        const Plane plane{glm::normalize(normal), offset};
        const Image uncut = Rasterizer().forward(one, camera, std::nullopt, options);
        check(plane, Rasterizer().forward(one, camera, plane, options).data, uncut.data,
              kPhiError + 1e-5, range);
        if (target == hwy::SupportedAndGeneratedTargets().front()) {
          check(plane, reference_render(p, one, camera, plane, options),
                reference_render(p, one, camera, std::nullopt, options), kPhiError + 1e-5, range);
        }
      }
    }
    EXPECT_LT(range.x, -4);
    EXPECT_GT(range.y, 4);
  }
  hwy::SetSupportedTargetsForTest(0);
}

TEST(ExactClip, EqualsTheHalfSpaceIntegralAlongTheRay) {
  // One large Gaussian seen from far away, where the affine projection is nearly the perspective
  // one, and large on the screen, where the blur is negligible: integrate its density along each
  // pixel's ray, over the kept half only and over all of it.
  Gaussians one(1, 0);
  const Vec3 deviations(9, 4, 6);
  for (int a = 0; a < 3; ++a) {
    one.plane(Gaussians::kLogScale + a)[0] = std::log(deviations[a]);
  }
  const float q[4] = {0.8f, 0.3f, -0.4f, 0.2f};
  for (int a = 0; a < 4; ++a) {
    one.plane(Gaussians::kRotation + a)[0] = q[a];
  }
  one.plane(Gaussians::kOpacity)[0] = 0.0f;
  Camera camera = frame_sphere({{0, 0, 0}, 2000}, View{20, 10, 80}, 512, 512);
  RasterOptions options;
  options.alpha_min = 1e-6f;
  options.clip_sigma = 8;
  const std::vector<double> p = as_doubles(one);
  const auto cut = reference_render(p, one, camera, kPlane, options);
  const auto uncut = reference_render(p, one, camera, std::nullopt, options);
  const glm::dmat3 precision = glm::inverse(glm::dmat3(one.covariance(0)));
  const double distance = glm::length(camera.position);
  int compared = 0;
  for (int y = 32; y < 512; y += 56) {
    for (int x = 32; x < 512; x += 56) {
      const size_t at = (static_cast<size_t>(y) * 512 + x) * 4 + 3;
      if (uncut[at] < 0.02) {
        continue;
      }
      const glm::dvec3 direction(camera.ray_direction(x + 0.5f, y + 0.5f));
      double kept = 0;
      double all = 0;
      for (double s = distance - 80; s < distance + 80; s += 0.05) {
        const glm::dvec3 world = glm::dvec3(camera.position) + s * direction;
        const double density = std::exp(-0.5 * glm::dot(world, precision * world));
        all += density;
        kept += glm::dot(glm::dvec3(kPlane.normal), world) > kPlane.offset ? density : 0;
      }
      EXPECT_NEAR(cut[at] / uncut[at], kept / all, 2e-3) << x << "," << y;
      ++compared;
    }
  }
  EXPECT_GT(compared, 20);
}

}  // namespace
}  // namespace clipgs
