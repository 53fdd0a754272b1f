#include "asset/sog.h"

#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>

#include "asset/webp.h"
#include "core/error.h"
#include "core/parallel.h"
#include "splat/sh.h"
#include "splat/test_scene.h"

namespace clipgs {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr size_t kCount = 2000;

/// As random_gaussians, in metres around (0.1, −0.3, 1.2).
Gaussians metric_gaussians(size_t count, int degree, std::uint64_t seed) {
  Gaussians g = random_gaussians(count, degree, seed, Vec3(0.1f, -0.3f, 1.2f), 0.12f);
  for (int axis = 0; axis < 3; ++axis) {
    for (size_t i = 0; i < count; ++i) {
      g.plane(Gaussians::kLogScale + axis)[i] -= std::log(1000.0f);
    }
  }
  return g;
}

struct RoundTrip {
  Gaussians before;
  Gaussians after;  // in the order of `before`
  nlohmann::json meta;
  std::vector<ZipEntry> files;
};

RoundTrip round_trip(const Gaussians& before) {
  RoundTrip result{before, {}, {}, {}};
  result.meta = encode_sog(before, result.files);
  std::map<std::string, Bytes> files;
  for (const ZipEntry& file : result.files) {
    files[file.name] = file.bytes;
  }
  const Gaussians read = decode_sog(result.meta, files, "test.sog");
  std::vector<size_t> order;
  for (size_t i = 0; i < before.size(); ++i) {
    size_t nearest = 0;
    for (size_t k = 1; k < read.size(); ++k) {
      if (glm::distance(read.mean(k), before.mean(i)) <
          glm::distance(read.mean(nearest), before.mean(i))) {
        nearest = k;
      }
    }
    order.push_back(nearest);
  }
  result.after = read.gather(order);
  return result;
}

double rms_difference(const RoundTrip& t, int first_plane, int count) {
  double sum = 0;
  for (int p = first_plane; p < first_plane + count; ++p) {
    for (size_t i = 0; i < t.before.size(); ++i) {
      sum += std::pow(t.before.plane(p)[i] - t.after.plane(p)[i], 2);
    }
  }
  return std::sqrt(sum / static_cast<double>(t.before.size() * count));
}

TEST(Sog, EveryParameterSurvivesWithinItsQuantisation) {
  for (int degree = 0; degree <= kMaxShDegree; ++degree) {
    const RoundTrip t = round_trip(metric_gaussians(kCount, degree, 11));
    ASSERT_EQ(t.after.sh_degree(), degree);
    for (size_t i = 0; i < kCount; ++i) {
      // A 16-bit step of ln(|x| + 1) over 0.24 m, at |x| + 1 < 2.5.
      EXPECT_LT(glm::length(t.after.mean(i) - t.before.mean(i)), 6e-6f);
      EXPECT_LE(std::abs(t.after.opacity(i) - t.before.opacity(i)), 0.501f / 255);
      // 8 bits of a quaternion's components: half a step of √2/255 in three of them.
      const float dot = std::abs(glm::dot(t.after.rotation(i), t.before.rotation(i)));
      EXPECT_LT(2 * std::acos(std::min(dot, 1.0f)), 0.02f);
    }
    EXPECT_LT(rms_difference(t, Gaussians::kLogScale, 3), 0.008);
    EXPECT_LT(rms_difference(t, Gaussians::kSh, 3), 0.01);
    if (degree > 0) {
      const int planes = 3 * (sh_coefficients(degree) - 1);
      // The noise of the test's coefficients is 0.05; a palette cannot be worse than that.
      EXPECT_LT(rms_difference(t, Gaussians::kSh + 3, planes), 0.05);
    }
  }
}

TEST(Sog, FaceColoursSurviveAsAPalette) {
  const Gaussians faces = random_faces(kCount, 1, 11);
  Gaussians g = metric_gaussians(kCount, 1, 11).reshaped(1, true);
  for (int p = g.face(); p < g.planes(); ++p) {
    std::copy_n(faces.plane(p), kCount, g.plane(p));
  }
  const RoundTrip t = round_trip(g);
  ASSERT_TRUE(t.after.has_face_colors());
  EXPECT_EQ(t.files.size(), 9u);
  EXPECT_LT(rms_difference(t, Gaussians::kSh + 3, 9), 0.05);
  EXPECT_LT(rms_difference(t, g.face(), Gaussians::kFacePlanes), 0.1);  // that of a palette of one
  EXPECT_GT(rms_difference(t, g.face(), Gaussians::kFacePlanes), 0);
}

TEST(Sog, HasTheLayoutOfVersion2) {
  const RoundTrip t = round_trip(metric_gaussians(kCount, 2, 12));
  EXPECT_EQ(t.meta["version"], 2);
  EXPECT_EQ(t.meta["count"], kCount);
  EXPECT_THAT(t.meta["asset"]["generator"].get<std::string>(), HasSubstr("clipgs"));
  EXPECT_EQ(t.meta["means"]["mins"].size(), 3u);
  EXPECT_EQ(t.meta["means"]["files"].size(), 2u);
  EXPECT_EQ(t.meta["scales"]["codebook"].size(), 256u);
  EXPECT_EQ(t.meta["sh0"]["codebook"].size(), 256u);
  EXPECT_EQ(t.meta["shN"]["codebook"].size(), 256u);
  EXPECT_EQ(t.meta["shN"]["bands"], 2);
  const size_t palette = t.meta["shN"]["count"];
  for (const ZipEntry& file : t.files) {
    if (file.name == "shN_centroids.webp") {
      EXPECT_NO_THROW(
          decode_webp(file.bytes, 64 * 8, static_cast<int>((palette + 63) / 64), file.name));
    } else {
      EXPECT_NO_THROW(decode_webp(file.bytes, 48, 44, file.name));  // 4⌈√2000/4⌉ × 4⌈2000/(4·48)⌉
    }
  }
  EXPECT_EQ(t.files.size(), 7u);
}

TEST(Sog, KnownSplatDecodesByHand) {
  Gaussians g(1, 0);
  g.plane(0)[0] = 0.5f;
  g.plane(Gaussians::kRotation)[0] = -0.5f;
  g.plane(Gaussians::kRotation + 2)[0] = 2.0f;  // y is the largest
  g.plane(Gaussians::kOpacity)[0] = 100;
  std::vector<ZipEntry> files;
  const nlohmann::json meta = encode_sog(g, files);
  EXPECT_NEAR(meta["means"]["mins"][0].get<double>(), std::log(1.5), 1e-9);
  for (const ZipEntry& file : files) {
    const Texels t = decode_webp(file.bytes, 4, 4, file.name);
    if (file.name == "quats.webp") {
      EXPECT_EQ(t.rgba[3], 252 + 2);
      const double w = -0.5 / std::sqrt(4.25);  // and y is positive already
      EXPECT_EQ(t.rgba[0], std::lround(255 * (w * std::sqrt(2.0) / 2 + 0.5)));
      EXPECT_EQ(t.rgba[1], 128);  // x = 0
    } else if (file.name == "sh0.webp") {
      EXPECT_EQ(t.rgba[3], 255);
    }
  }
}

TEST(Sog, OrderOfTheInputDoesNotMatter) {
  const Gaussians g = metric_gaussians(kCount, 1, 13);
  std::vector<size_t> order(kCount);
  for (size_t i = 0; i < kCount; ++i) {
    order[i] = (i * 7 + 3) % kCount;  // 7 and 2000 have no common factor
  }
  std::vector<ZipEntry> straight;
  std::vector<ZipEntry> shuffled;
  EXPECT_EQ(encode_sog(g, straight), encode_sog(g.gather(order), shuffled));
  EXPECT_EQ(write_zip(straight), write_zip(shuffled));
}

TEST(Sog, ExtremeButFiniteScenesArePacked) {
  Gaussians g(3, 1);
  g.plane(Gaussians::kLogScale)[0] = -200;
  g.plane(Gaussians::kOpacity)[1] = -100;
  g.plane(Gaussians::kSh + 3)[2] = 1e9f;
  const RoundTrip t = round_trip(g);  // all at one place, unrotated
  for (const float value : t.after.data()) {
    EXPECT_TRUE(std::isfinite(value));
  }
}

TEST(Sog, RefusesWhatCannotBePacked) {
  std::vector<ZipEntry> files;
  EXPECT_THAT([&] { encode_sog(Gaussians(0, 0), files); },
              ThrowsMessage<Error>(HasSubstr("has 0")));
  Gaussians g = metric_gaussians(10, 0, 1);
  g.plane(Gaussians::kOpacity)[4] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT([&] { encode_sog(g, files); }, ThrowsMessage<Error>(HasSubstr("splat 4")));
  g = metric_gaussians(10, 0, 1);
  g.plane(0)[5] = 1e30f;
  EXPECT_THAT([&] { encode_sog(g, files); }, ThrowsMessage<Error>(HasSubstr("splat 5")));
}

TEST(Webp, TexelsAreExactUnderAnyAlpha) {
  Texels t(64, 48);
  Rng rng(9);
  for (std::uint8_t& byte : t.rgba) {
    byte = static_cast<std::uint8_t>(rng.below(256));
  }
  for (size_t i = 3; i < t.rgba.size(); i += 8) {
    t.rgba[i] = 0;
  }
  EXPECT_EQ(decode_webp(encode_webp(t), 64, 48, "test").rgba, t.rgba);
  EXPECT_EQ(decode_webp(encode_webp(t, Saving::kTime), 64, 48, "test").rgba, t.rgba);
  EXPECT_THAT([&] { decode_webp(encode_webp(t), 64, 64, "x.webp"); },
              ThrowsMessage<Error>(HasSubstr("64 × 48")));
}

}  // namespace
}  // namespace clipgs
