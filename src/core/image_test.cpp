#include "core/image.h"

#include <cmath>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"
#include "core/file.h"
#include "core/random.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

TEST(Image, SrgbRoundTrips) {
  for (int i = 0; i <= 255; ++i) {
    const float v = static_cast<float>(i) / 255.0f;
    EXPECT_NEAR(srgb_from_linear(linear_from_srgb(v)), v, 1e-5);
  }
}

TEST(Image, PngRoundTripsAtBothDepths) {
  const fs::path path = fs::path(testing::TempDir()) / fmt::format("clipgs-{}.png", getpid());
  Rng rng(1);
  for (const int channels : {3, 4}) {
    for (const int bits : {8, 16}) {
      Image image(17, 9, channels);
      for (float& v : image.data) {
        v = rng.uniform();
      }
      write_png(path, image, bits);
      const Image back = read_png(path);
      ASSERT_EQ(back.channels, channels);
      ASSERT_EQ(back.data.size(), image.data.size());
      for (size_t i = 0; i < back.data.size(); ++i) {
        EXPECT_NEAR(back.data[i], image.data[i], 0.51f / (bits == 8 ? 255.0f : 65535.0f));
      }
    }
  }
  fs::remove(path);
}

TEST(Image, TruncatedPngThrows) {
  const fs::path path = fs::path(testing::TempDir()) / fmt::format("clipgs-cut-{}.png", getpid());
  write_png(path, Image(32, 32, 4));
  const std::vector<std::uint8_t> bytes = read_file(path);
  for (const size_t length : {size_t{0}, size_t{7}, size_t{20}, bytes.size() / 2}) {
    write_file(path, bytes.data(), length);
    EXPECT_THROW(read_png(path), Error) << length;
  }
  fs::remove(path);
}

// Radiance's format: the mantissas of three channels and an exponent for all.
TEST(Image, HdrIsRead) {
  const fs::path path = fs::path(testing::TempDir()) / fmt::format("clipgs-{}.hdr", getpid());
  const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
  const std::string pixels("\x80\x40\x00\x81\x80\x80\x80\x85", 8);
  write_text(path, header + pixels);
  const Image image = read_hdr(path);
  ASSERT_EQ(image.width, 2);
  ASSERT_EQ(image.height, 1);
  EXPECT_EQ(image.data, (std::vector<float>{1, 0.5f, 0, 16, 16, 16}));
  for (const char* damaged :
       {"", "#?RADIANCE\n", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 99999\n",
        "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y -3 +X 2\n"}) {
    write_text(path, damaged);
    EXPECT_THROW(read_hdr(path), Error) << damaged;
  }
  fs::remove(path);
  EXPECT_THROW(read_hdr(path), Error);
}

// Runs and copies of every channel; what does not fit the row, or ends before it, is refused.
TEST(Image, PackedHdrIsRead) {
  const fs::path path = fs::path(testing::TempDir()) / fmt::format("clipgs-{}.hdr", getpid());
  const auto read = [&](const std::string& channels) {
    write_text(path, "#?RGBE\n# made by hand\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n" +
                         std::string("\2\2\0\10", 4) + channels);
    return read_hdr(path);
  };
  const std::string run_and_copy("\x86\x40\x02\x80\x20", 5);
  const std::string zeros("\x88\0", 2);
  const std::string exponents("\x88\x81", 2);
  const Image image = read(run_and_copy + zeros + zeros + exponents);
  ASSERT_EQ(image.width, 8);
  EXPECT_EQ(image.at(0, 0)[0], 0.5f);
  EXPECT_EQ(image.at(5, 0)[0], 0.5f);
  EXPECT_EQ(image.at(6, 0)[0], 1.0f);
  EXPECT_EQ(image.at(7, 0)[0], 0.25f);
  EXPECT_EQ(image.at(7, 0)[1], 0.0f);
  for (const std::string& damaged :
       {std::string("\x88\x50"), std::string("\x89\x50"), std::string("\0\0\0\0\0\0\0\0", 8),
        std::string("\x80\x50\x50\x50\x50\x50\x50\x50\x50")}) {
    EXPECT_THROW(read(damaged), Error);
  }
  fs::remove(path);
}

// Rows from the lowest up; floats of either order of bytes; grey in all channels.
TEST(Image, PfmIsRead) {
  const fs::path path = fs::path(testing::TempDir()) / fmt::format("clipgs-{}.pfm", getpid());
  const auto read = [&](const std::string& text) {
    write_text(path, text);
    return read_pfm(path);
  };
  const std::string one("\0\0\x80\x3f", 4);
  const std::string nan("\0\0\xc0\x7f", 4);
  const Image image = read("PF\n1 2\n-1.0\n" + one + one + one + nan + one + one);
  ASSERT_EQ(image.width, 1);
  ASSERT_EQ(image.height, 2);
  EXPECT_TRUE(std::isnan(image.at(0, 0)[0]));
  EXPECT_EQ(image.at(0, 1)[0], 1);
  const Image grey = read("Pf 2 1 1 " + std::string("\x3f\x80\0\0\x40\0\0\0", 8));
  EXPECT_EQ(grey.data, (std::vector<float>{1, 1, 1, 2, 2, 2}));
  for (const std::string& damaged :
       {std::string(), std::string("PF"), "PG 1 1 -1 " + one, "Pf 1 1 0 " + one,
        "Pf 1 1 nan " + one, "Pf 0 1 -1 " + one, "Pf 1 99999 -1 " + one, "Pf 2 1 -1 " + one,
        "PF 16384 16384 -1 " + one, "Pf 1 -1 -1 " + one, "Pf 1x 1 -1 " + one}) {
    EXPECT_THROW(read(damaged), Error) << damaged;
  }
  fs::remove(path);
  EXPECT_THROW(read_pfm(path), Error);
}

TEST(Image, CompositeUsesStraightAlpha) {
  Image image(1, 1, 4);
  image.data = {1.0f, 0.5f, 0.0f, 0.25f};
  const Image out = composite(image, 0, 0, 1);
  EXPECT_FLOAT_EQ(out.data[0], 0.25f);
  EXPECT_FLOAT_EQ(out.data[1], 0.125f);
  EXPECT_FLOAT_EQ(out.data[2], 0.75f);
}

}  // namespace
}  // namespace clipgs
