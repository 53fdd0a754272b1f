#include "cinema/denoise.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "cinema/test_scenes.h"
#include "core/geometry.h"
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
float patch_difference(const Guide& color, glm::ivec2 p, glm::ivec2 q, glm::ivec2 size) {
  float sum = 0;
  int count = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const glm::ivec2 low = glm::min(p, q) + glm::ivec2(dx, dy);
      const glm::ivec2 high = glm::max(p, q) + glm::ivec2(dx, dy);
      if (low.x >= 0 && low.y >= 0 && high.x < size.x && high.y < size.y) {
        sum += difference(color, (p.y + dy) * size.x + p.x + dx, (q.y + dy) * size.x + q.x + dx,
                          0.35f, 1e-6f);
        ++count;
      }
    }
  }
  return sum / static_cast<float>(count);
}

Image filtered(const Image& source, const Guide& color, const Guide& albedo) {
  const glm::ivec2 size(source.width, source.height);
  Image result(size.x, size.y, 4);
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      float weights = 0;
      for (int v = std::max(0, y - 6); v <= std::min(size.y - 1, y + 6); ++v) {
        for (int u = std::max(0, x - 6); u <= std::min(size.x - 1, x + 6); ++u) {
          const float feature = difference(albedo, y * size.x + x, v * size.x + u, 0.6f, 2e-3f);
          if (feature > 6) {
            continue;
          }
          const float patch = patch_difference(color, {x, y}, {u, v}, size);
          const float weight = std::exp(-std::max({0.0f, patch, feature}));
          weights += weight;
          for (int c = 0; c < 4; ++c) {
            result.at(x, y)[c] += weight * source.at(u, v)[c];
          }
        }
      }
      for (int c = 0; c < 4; ++c) {
        result.at(x, y)[c] /= weights;
      }
    }
  }
  return result;
}

Picture denoise(const Picture& picture, float exposure) {
  const int width = picture.half_a.width;
  const int height = picture.half_a.height;
  const std::vector<Vec4> a = stabilized(picture.half_a, exposure);
  const std::vector<Vec4> b = stabilized(picture.half_b, exposure);
  const std::vector<float> variance = variance_of(a, b, width, height);
  Guide albedo{stabilized(picture.albedo_a, 1), {}};
  const std::vector<Vec4> other = stabilized(picture.albedo_b, 1);
  albedo.variance = variance_of(albedo.values, other, width, height);
  for (size_t i = 0; i < other.size(); ++i) {
    albedo.values[i] = 0.5f * (albedo.values[i] + other[i]);
    albedo.variance[i] *= 0.5f;
  }
  Picture result = picture;
  result.half_a = filtered(picture.half_a, {b, variance}, albedo);
  result.half_b = filtered(picture.half_b, {a, variance}, albedo);
  return result;
}

}  // namespace reference

/// Noise over fields of different brightness, coverage and albedo that meet in edges; the darkest
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
  fill(picture.albedo_a, 3, 0.3f);
  fill(picture.albedo_b, 3, 0.3f);
  return picture;
}

float largest_difference(const Image& a, const Image& b) {
  float largest = 0;
  for (size_t i = 0; i < a.data.size(); ++i) {
    largest = std::max(largest, std::abs(a.data[i] - b.data[i]));
  }
  return largest;
}

void expect_as_defined(const Picture& noisy, float exposure) {
  const Picture expected = reference::denoise(noisy, exposure);
  const Picture result = denoise(noisy, exposure);
  ASSERT_EQ(result.half_a.data.size(), expected.half_a.data.size());
  ASSERT_EQ(result.half_b.data.size(), expected.half_b.data.size());
  EXPECT_LT(largest_difference(result.half_a, expected.half_a), 1e-5f);
  EXPECT_LT(largest_difference(result.half_b, expected.half_b), 1e-5f);
  EXPECT_GT(largest_difference(result.half_a, noisy.half_a), 0.01f);  // something was done
}

TEST(Denoise, IsAsDefinedInARenderedPicture) { expect_as_defined(torso(4, 5), 1.5f); }

TEST(Denoise, IsAsDefinedAtEdgesAndBorders) {
  // More than one tile and no whole number of them; narrower or lower than the window.
  for (const glm::ivec2 size :
       {glm::ivec2(131, 37), glm::ivec2(5, 40), glm::ivec2(70, 2), glm::ivec2(2, 3)}) {
    SCOPED_TRACE(std::to_string(size.x) + " x " + std::to_string(size.y));
    expect_as_defined(noisy_fields(size.x, size.y), 1);
  }
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
