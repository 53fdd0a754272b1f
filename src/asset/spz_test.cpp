#include "asset/spz.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>
#include <zlib.h>

#include "core/error.h"
#include "core/random.h"

namespace clipgs {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

Gaussians random_splats(size_t count, int degree) {
  Gaussians splats(count, degree);
  Rng rng(7);
  const auto random = [&](float reach) {
    return reach * (static_cast<float>(rng.below(20001)) / 10000 - 1);
  };
  for (size_t i = 0; i < count; ++i) {
    for (int a = 0; a < 3; ++a) {
      splats.plane(Gaussians::kMean + a)[i] = random(0.4f);
      splats.plane(Gaussians::kLogScale + a)[i] = -5 + random(2);
      splats.plane(Gaussians::kSh + a)[i] = random(1.5f);
    }
    for (int k = 0; k < 4; ++k) {
      splats.plane(Gaussians::kRotation + k)[i] = random(1);
    }
    splats.plane(Gaussians::kOpacity)[i] = random(4);
    for (int p = Gaussians::kSh + 3; p < splats.planes(); ++p) {
      splats.plane(p)[i] = random(0.5f);
    }
  }
  return splats;
}

class Spz : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degrees, Spz, testing::Values(0, 1, 2, 3));

TEST_P(Spz, ComesBackAsFineAsItsCodes) {
  const Gaussians splats = random_splats(300, GetParam());
  const Gaussians back = decode_spz(encode_spz(splats), "test");
  EXPECT_EQ(decode_spz(encode_spz(splats, kOldSpzVersion), "test").data(), back.data());
  ASSERT_EQ(back.size(), splats.size());
  ASSERT_EQ(back.sh_degree(), splats.sh_degree());
  for (size_t i = 0; i < splats.size(); ++i) {
    EXPECT_LT(glm::length(back.mean(i) - splats.mean(i)), 1e-5f);
    EXPECT_LT(std::abs(std::abs(glm::dot(back.rotation(i), splats.rotation(i))) - 1), 1e-4f);
    EXPECT_NEAR(back.opacity(i), splats.opacity(i), 0.5f / 255 + 1e-4f);
    for (int a = 0; a < 3; ++a) {
      EXPECT_NEAR(back.plane(Gaussians::kLogScale + a)[i],
                  splats.plane(Gaussians::kLogScale + a)[i], 0.5f / 16 + 1e-4f);
      EXPECT_NEAR(back.plane(Gaussians::kSh + a)[i], splats.plane(Gaussians::kSh + a)[i],
                  0.5f / 255 / 0.15f + 1e-4f);
    }
    for (int p = Gaussians::kSh + 3; p < splats.planes(); ++p) {
      EXPECT_NEAR(back.plane(p)[i], splats.plane(p)[i], 4.5f / 128 + 1e-4f);
    }
  }
}

TEST(SpzFile, IsOneForTheSameSplats) {
  const Gaussians splats = random_splats(50, 2);
  EXPECT_EQ(encode_spz(splats), encode_spz(splats));
}

/// A file of version 2 or 3 with one splat of degree 0 at (1, 2, 3), x right, y up, z back.
Bytes old_file(std::uint8_t version) {
  Bytes plain = {0x4e, 0x47, 0x53, 0x50, version, 0, 0, 0, 1, 0, 0, 0, 0, 8, 0, 0};
  const Bytes place = {0, 1, 0, 0, 2, 0, 0, 3, 0};  // 256 a unit
  plain.insert(plain.end(), place.begin(), place.end());
  const Bytes rest = {255, 128, 128, 128, 160, 160, 160};  // opaque, grey, of size 1
  plain.insert(plain.end(), rest.begin(), rest.end());
  const Bytes turn = version == 2 ? Bytes{128, 128, 128} : Bytes{0, 0, 0, 0xc0};  // none
  plain.insert(plain.end(), turn.begin(), turn.end());
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  Bytes packed(200);
  stream.next_in = plain.data();
  stream.avail_in = static_cast<uInt>(plain.size());
  stream.next_out = packed.data();
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

TEST(SpzFile, OfOlderVersionsIsRead) {
  for (const std::uint8_t version : {2, 3}) {
    const Gaussians splats = decode_spz(old_file(version), "test");
    ASSERT_EQ(splats.size(), 1);
    EXPECT_LT(glm::length(splats.mean(0) - Vec3(1, -2, -3)), 1e-5f);
    EXPECT_NEAR(splats.scale(0).x, 1, 1e-4f);
    EXPECT_GT(splats.opacity(0), 0.99f);
  }
}

TEST(SpzFile, ThatIsBrokenIsRefusedInALine) {
  const Bytes good = encode_spz(random_splats(40, 1));
  const auto refused = [](const Bytes& bytes) {
    EXPECT_THAT([&] { decode_spz(bytes, "a.spz"); },
                ThrowsMessage<Error>(::testing::AllOf(HasSubstr("a.spz"), Not(HasSubstr("\n")))));
  };
  refused({});
  refused({0x1f, 0x8b, 3});
  for (const size_t size : {3UL, 20UL, 40UL, good.size() / 2, good.size() - 1}) {
    refused(Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)));
  }
  const auto with = [&](size_t at, std::uint8_t value) {
    Bytes bad = good;
    bad[at] = value;
    return bad;
  };
  refused(with(0, 1));
  refused(with(4, 5));     // version
  refused(with(11, 255));  // splats
  refused(with(12, 9));    // degree
  refused(with(15, 2));    // streams
  refused(with(16, 4));    // where the table is
  std::mt19937 random(3);
  for (int k = 0; k < 300; ++k) {
    Bytes bad = good;
    bad[random() % bad.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
    try {
      decode_spz(bad, "a.spz");
    } catch (const Error&) {
    }
  }
}

}  // namespace
}  // namespace clipgs
