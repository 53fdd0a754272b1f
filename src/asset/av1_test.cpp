#include "asset/av1.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>

#include "core/error.h"
#include "core/parallel.h"

namespace clipgs {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

/// Odd sides, as volumes have them.
constexpr IVec3 kDims{45, 37, 20};

/// A ball that shifts a little from slice to slice, and noise.
std::vector<std::uint8_t> moving_ball() {
  std::mt19937 random(5);
  std::vector<std::uint8_t> voxels;
  for (int z = 0; z < kDims.z; ++z) {
    for (int y = 0; y < kDims.y; ++y) {
      for (int x = 0; x < kDims.x; ++x) {
        const double r = std::hypot(x - 15 - 0.4 * z, y - 18, z - 10);
        const double soft = 200 / (1 + std::exp(r - 9));
        voxels.push_back(static_cast<std::uint8_t>(std::lround(soft + random() % 8)));
      }
    }
  }
  return voxels;
}

double rms(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  double squares = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    squares += std::pow(static_cast<double>(a[i]) - b[i], 2);
  }
  return std::sqrt(squares / static_cast<double>(a.size()));
}

TEST(Av1, TellsVoxelsBackTheBetterTheMoreBytesItHas) {
  const std::vector<std::uint8_t> voxels = moving_ball();
  double before = 0;
  size_t bytes = voxels.size();
  for (const int level : {2, 10, 20, 40}) {
    const Bytes stream = encode_av1(voxels, kDims, level);
    const std::vector<std::uint8_t> back = decode_av1(stream, kDims, "test");
    ASSERT_EQ(back.size(), voxels.size());
    EXPECT_LT(stream.size(), bytes);
    EXPECT_GT(rms(back, voxels), before);
    bytes = stream.size();
    before = rms(back, voxels);
  }
  EXPECT_LT(rms(decode_av1(encode_av1(voxels, kDims, 2), kDims, "test"), voxels), 1);
  EXPECT_LT(before, 6);
}

TEST(Av1, TakesSlicesOfAnySize) {
  for (const IVec3 dims : {IVec3(1, 1, 1), IVec3(1, 70, 3), IVec3(300, 2, 2), IVec3(16, 16, 65)}) {
    const std::vector<std::uint8_t> voxels(static_cast<size_t>(dims.x) * dims.y * dims.z, 77);
    const std::vector<std::uint8_t> back = decode_av1(encode_av1(voxels, dims, 6), dims, "test");
    ASSERT_EQ(back.size(), voxels.size());
    EXPECT_LT(rms(back, voxels), 1.5);
  }
}

TEST(Av1, IsTheSameBytesAtAnyNumberOfThreads) {
  const IVec3 dims(150, 130, 30);
  std::mt19937 random(2);
  std::vector<std::uint8_t> voxels(static_cast<size_t>(dims.x) * dims.y * dims.z);
  for (size_t i = 0; i < voxels.size(); ++i) {
    const double wave = std::sin(0.1 * static_cast<double>(i % 150)) * 60;
    voxels[i] = static_cast<std::uint8_t>(std::lround(100 + wave + random() % 16));
  }
  set_thread_count(1);
  const Bytes one = encode_av1(voxels, dims, 10);
  set_thread_count(4);
  const Bytes four = encode_av1(voxels, dims, 10);
  const std::vector<std::uint8_t> back = decode_av1(four, dims, "test");
  set_thread_count(0);
  EXPECT_TRUE(one == four);
  EXPECT_TRUE(back == decode_av1(one, dims, "test"));
}

TEST(Av1, RefusesWhatIsDamagedOrOfAnotherSize) {
  const Bytes good = encode_av1(moving_ball(), kDims, 10);
  const auto refused = [](const Bytes& bytes, const IVec3& dims) {
    EXPECT_THAT([&] { decode_av1(bytes, dims, "a.sog"); },
                ThrowsMessage<Error>(::testing::AllOf(HasSubstr("a.sog"), Not(HasSubstr("\n")))));
  };
  refused({}, kDims);
  refused({1, 2, 3}, kDims);
  refused(Bytes(500, 0xff), kDims);
  refused(Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(good.size() / 2)), kDims);
  refused(good, kDims + IVec3(1, 0, 0));
  refused(good, kDims - IVec3(0, 1, 0));
  refused(good, kDims + IVec3(0, 0, 1));
  refused(good, kDims - IVec3(0, 0, 1));
}

TEST(Av1, FlippedBitsAreRefusedOrDecodeToSomethingOfTheSameSize) {
  const Bytes good = encode_av1(moving_ball(), kDims, 20);
  std::mt19937 random(9);
  for (int k = 0; k < 200; ++k) {
    Bytes bad = good;
    bad[random() % bad.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
    try {
      EXPECT_EQ(decode_av1(bad, kDims, "test").size(), moving_ball().size());
    } catch (const Error&) {
    }
  }
}

}  // namespace
}  // namespace clipgs
