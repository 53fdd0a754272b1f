#include "cinema/denoise.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "cinema/test_scenes.h"
#include "core/error.h"
#include "core/geometry.h"
#include "core/parallel.h"
#include "volume/phantom.h"

namespace clipgs {
namespace {

constexpr int kSize = 48;  // px, unless more must be seen

/// The phantom cut open, with its few samples or with many.
Picture torso(int spp, std::uint64_t seed, int size = kSize) {
  static const Volume volume = make_phantom(64);
  static const CinemaScene scene(volume, load_preset("skin-and-bone"));
  const Camera camera = frame_sphere({Vec3(0), 190}, View{30, 20, 1}, size, size);
  PictureOptions options;
  options.spp = spp;
  options.seed = seed;
  options.features = true;
  return render_picture(scene, camera, Plane{Vec3(0, -1, 0), 0}, options);
}

double psnr(const Image& a, const Image& b) {
  const Image da = display(a, {});
  const Image db = display(b, {});
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

/// The same filter, pixel by pixel as it is defined.
namespace reference {

struct Guide {
  std::vector<Vec4> values;
  std::vector<float> variance;
};

std::vector<Vec4> stabilized(const Image& half, float exposure) {
  std::vector<Vec4> values(half.pixels());
  for (size_t i = 0; i < values.size(); ++i) {
    const float* p = &half.data[i * half.channels];
    for (int c = 0; c < 3; ++c) {
      values[i][c] = std::sqrt(std::max(0.0f, exposure * p[c]));
    }
    values[i].w = half.channels == 4 ? p[3] : 0.0f;
  }
  return values;
}

std::vector<float> variance_of(const std::vector<Vec4>& a, const std::vector<Vec4>& b, int width,
                               int height) {
  std::vector<float> result;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      float sum = 0;
      int count = 0;
      for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
          const Vec4 difference = a[v * width + u] - b[v * width + u];
          sum += glm::dot(difference, difference) / 8;
          ++count;
        }
      }
      result.push_back(sum / static_cast<float>(count));
    }
  }
  return result;
}

float difference(const Guide& guide, int p, int q, float strictness, float least) {
  const Vec4 d = guide.values[p] - guide.values[q];
  const float vp = guide.variance[p];
  const float vq = guide.variance[q];
  return (0.25f * glm::dot(d, d) - (vp + std::min(vp, vq))) /
         (least + strictness * strictness * (vp + vq));
}

/// Mean of the differences of what surrounds two pixels.
float patch_difference(const Guide& guide, glm::ivec2 p, glm::ivec2 q, glm::ivec2 size,
                       float strictness, float least) {
  float sum = 0;
  int count = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const glm::ivec2 low = glm::min(p, q) + glm::ivec2(dx, dy);
      const glm::ivec2 high = glm::max(p, q) + glm::ivec2(dx, dy);
      if (low.x >= 0 && low.y >= 0 && high.x < size.x && high.y < size.y) {
        sum += difference(guide, (p.y + dy) * size.x + p.x + dx, (q.y + dy) * size.x + q.x + dx,
                          strictness, least);
        ++count;
      }
    }
  }
  return sum / static_cast<float>(count);
}

struct Feature {
  Guide guide;
  float least;
};

struct Comparison {
  int window;
  float strictness;
  float least;
};

std::vector<Vec4> filtered(const std::vector<Vec4>& source, const Guide& guide,
                           const std::vector<Feature>& features, const Comparison& comparison,
                           glm::ivec2 size) {
  std::vector<Vec4> result;
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      float weights = 0;
      Vec4 sum(0);
      const int w = comparison.window;
      for (int v = std::max(0, y - w); v <= std::min(size.y - 1, y + w); ++v) {
        for (int u = std::max(0, x - w); u <= std::min(size.x - 1, x + w); ++u) {
          float largest = std::max(0.0f, patch_difference(guide, {x, y}, {u, v}, size,
                                                          comparison.strictness, comparison.least));
          for (const Feature& f : features) {
            largest =
                std::max(largest, difference(f.guide, y * size.x + x, v * size.x + u, 1, f.least));
          }
          const float weight = std::exp(-largest);
          weights += weight;
          sum += weight * source[v * size.x + u];
        }
      }
      result.push_back(sum / weights);
    }
  }
  return result;
}

Feature feature(const std::vector<Vec4>& a, const std::vector<Vec4>& b, float least,
                glm::ivec2 size) {
  const std::vector<float> variance = variance_of(a, b, size.x, size.y);
  const std::vector<Vec4> clean_a = filtered(a, {b, variance}, {}, {2, 1, 0.1f * least}, size);
  const std::vector<Vec4> clean_b = filtered(b, {a, variance}, {}, {2, 1, 0.1f * least}, size);
  Feature result{{{}, variance_of(clean_a, clean_b, size.x, size.y)}, least};
  for (size_t i = 0; i < a.size(); ++i) {
    result.guide.values.push_back(0.5f * (clean_a[i] + clean_b[i]));
    result.guide.variance[i] *= 0.5f;
  }
  return result;
}

std::vector<Vec4> values_of(const Image& image) {
  std::vector<Vec4> values(image.pixels(), Vec4(0));
  for (size_t i = 0; i < image.data.size(); ++i) {
    const auto channels = static_cast<size_t>(image.channels);
    values[i / channels][static_cast<int>(i % channels)] = image.data[i];
  }
  return values;
}

Image image_of(const std::vector<Vec4>& values, glm::ivec2 size) {
  Image image(size.x, size.y, 4);
  for (size_t i = 0; i < values.size(); ++i) {
    std::copy_n(&values[i][0], 4, &image.data[4 * i]);
  }
  return image;
}

std::vector<float> smoothed(const std::vector<float>& values, glm::ivec2 size, int radius) {
  std::vector<float> result;
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      float sum = 0;
      int count = 0;
      for (int v = std::max(0, y - radius); v <= std::min(size.y - 1, y + radius); ++v) {
        for (int u = std::max(0, x - radius); u <= std::min(size.x - 1, x + radius); ++u) {
          sum += values[v * size.x + u];
          ++count;
        }
      }
      result.push_back(sum / static_cast<float>(count));
    }
  }
  return result;
}

/// Squared differences of what two pictures show over black, a pixel.
std::vector<float> squares(const Image& left, const Image& right,
                           const DisplayTransform& transform) {
  const Image a = composite(display(left, transform), 0, 0, 0);
  const Image b = composite(display(right, transform), 0, 0, 0);
  std::vector<float> result(a.pixels());
  for (size_t i = 0; i < a.data.size(); ++i) {
    result[i / 3] += (a.data[i] - b.data[i]) * (a.data[i] - b.data[i]);
  }
  return result;
}

/// Takes as much of the filtered picture as its error and the noise say.
void mix(const Picture& noisy, const DisplayTransform& transform, glm::ivec2 size,
         Picture& filtered) {
  const std::vector<float> between = squares(noisy.half_a, noisy.half_b, transform);
  const std::vector<float> a = squares(filtered.half_a, noisy.half_b, transform);
  const std::vector<float> b = squares(filtered.half_b, noisy.half_a, transform);
  std::vector<float> of_noisy;
  std::vector<float> of_filtered;
  for (size_t i = 0; i < between.size(); ++i) {
    of_noisy.push_back(between[i] / 4);
    of_filtered.push_back((a[i] + b[i]) / 2 - between[i] / 2);
  }
  of_noisy = smoothed(of_noisy, size, 3);
  of_filtered = smoothed(of_filtered, size, 3);
  std::vector<float> share;
  for (size_t i = 0; i < between.size(); ++i) {
    const float sum = of_noisy[i] + std::max(0.0f, of_filtered[i]);
    share.push_back(sum > 0 ? of_noisy[i] / sum : 1);
  }
  share = smoothed(share, size, 1);
  for (size_t i = 0; i < noisy.half_a.data.size(); ++i) {
    const float s = share[i / 4];
    filtered.half_a.data[i] = (1 - s) * noisy.half_a.data[i] + s * filtered.half_a.data[i];
    filtered.half_b.data[i] = (1 - s) * noisy.half_b.data[i] + s * filtered.half_b.data[i];
  }
}

Picture denoise(const Picture& picture, const DisplayTransform& transform) {
  const glm::ivec2 size(picture.half_a.width, picture.half_a.height);
  const std::vector<Vec4> a = stabilized(picture.half_a, transform.exposure);
  const std::vector<Vec4> b = stabilized(picture.half_b, transform.exposure);
  const std::vector<float> variance = variance_of(a, b, size.x, size.y);
  const Features& fa = picture.features_a;
  const Features& fb = picture.features_b;
  const std::vector<Feature> features = {
      feature(stabilized(fa.albedo, 1), stabilized(fb.albedo, 1), 4e-3f, size),
      feature(values_of(fa.normal), values_of(fb.normal), 2e-2f, size),
      feature(values_of(fa.depth), values_of(fb.depth), 8, size)};
  const Comparison comparison = {6, 0.8f, 1e-6f};
  Picture result = picture;
  result.half_a = image_of(
      filtered(values_of(picture.half_a), {b, variance}, features, comparison, size), size);
  result.half_b = image_of(
      filtered(values_of(picture.half_b), {a, variance}, features, comparison, size), size);
  mix(picture, transform, size, result);
  return result;
}

}  // namespace reference

/// Noise over fields of different brightness, coverage and features that meet in edges; the darkest
/// has no noise at all.
Picture noisy_fields(int width, int height) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> noise(-0.2f, 0.2f);
  Picture picture;
  const auto fill = [&](Image& image, int channels, float strength) {
    image = Image(width, height, channels);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const int field = (x > width / 2 ? 1 : 0) + (2 * x + 3 * y > 2 * width ? 2 : 0);
        for (int c = 0; c < channels; ++c) {
          const float value = 0.3f * static_cast<float>(field) + 0.02f * static_cast<float>(c);
          image.at(x, y)[c] = field == 0 ? 0 : value + strength * noise(random);
        }
      }
    }
  };
  fill(picture.half_a, 4, 1);
  fill(picture.half_b, 4, 1);
  for (Features* features : {&picture.features_a, &picture.features_b}) {
    fill(features->albedo, 3, 0.3f);
    fill(features->normal, 3, 0.5f);
    fill(features->depth, 1, 9);
  }
  return picture;
}

float largest_difference(const Image& a, const Image& b) {
  float largest = 0;
  for (size_t i = 0; i < a.data.size(); ++i) {
    largest = std::max(largest, std::abs(a.data[i] - b.data[i]));
  }
  return largest;
}

void expect_as_defined(const Picture& noisy, const DisplayTransform& transform) {
  const Picture expected = reference::denoise(noisy, transform);
  const Picture result = denoise(noisy, transform);
  ASSERT_EQ(result.half_a.data.size(), expected.half_a.data.size());
  ASSERT_EQ(result.half_b.data.size(), expected.half_b.data.size());
  EXPECT_LT(largest_difference(result.half_a, expected.half_a), 1e-5f);
  EXPECT_LT(largest_difference(result.half_b, expected.half_b), 1e-5f);
  EXPECT_GT(largest_difference(result.half_a, noisy.half_a), 0.01f);  // something was done
}

TEST(Denoise, IsAsDefinedInARenderedPicture) {
  expect_as_defined(torso(4, 5), {1.5f});
  expect_as_defined(torso(4, 5), {1.5f, ToneCurve::kFilmic});
}

TEST(Denoise, IsAsDefinedAtEdgesAndBorders) {
  // More than one tile and no whole number of them; narrower or lower than the window.
  for (const glm::ivec2 size :
       {glm::ivec2(71, 19), glm::ivec2(5, 18), glm::ivec2(66, 2), glm::ivec2(2, 3)}) {
    SCOPED_TRACE(std::to_string(size.x) + " x " + std::to_string(size.y));
    expect_as_defined(noisy_fields(size.x, size.y), {});
  }
}

TEST(Denoise, BringsAPictureNearerToTheTruth) {
  constexpr int kLarger = 96;
  const Image truth = torso(192, 1, kLarger).mean();
  const Picture noisy = torso(4, 2, kLarger);
  const double before = psnr(noisy.mean(), truth);
  const double after = psnr(denoise(noisy, {}).mean(), truth);
  RecordProperty("before_db", std::to_string(before));
  RecordProperty("after_db", std::to_string(after));
  EXPECT_GT(after, before + 3) << before;
}

// Errors of the denoised picture, of which the bias is a part, go with the noise.
TEST(Denoise, BiasGoesAsSamplesGrow) {
  const Image truth = torso(512, 1).mean();
  for (const int spp : {16, 64, 192}) {
    const Picture noisy = torso(spp, 3);
    const double before = psnr(noisy.mean(), truth);
    const double after = psnr(denoise(noisy, {}).mean(), truth);
    EXPECT_LT(std::pow(10, -0.1 * after), 1.05 * std::pow(10, -0.1 * before)) << spp;
  }
}

TEST(Denoise, LeavesACleanPictureAlone) {
  const Picture clean = torso(256, 3);
  EXPECT_GT(psnr(denoise(clean, {}).mean(), clean.mean()), 45);
}

TEST(Denoise, NeedsFeatures) {
  Picture picture = noisy_fields(8, 8);
  picture.features_a = {};
  EXPECT_THROW(denoise(picture, {}), Error);
}

TEST(Denoise, SameBytesAtAnyThreadCount) {
  const Picture noisy = torso(8, 4);
  set_thread_count(1);
  const Picture one = denoise(noisy, {});
  set_thread_count(2);
  const Picture two = denoise(noisy, {});
  set_thread_count(0);
  EXPECT_EQ(one.half_a.data, two.half_a.data);
  EXPECT_EQ(one.half_b.data, two.half_b.data);
}

}  // namespace
}  // namespace clipgs
