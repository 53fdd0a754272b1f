#include "asset/webp_animation.h"

#include <gtest/gtest.h>
#include <webp/demux.h>

#include "core/error.h"

namespace clipgs {
namespace {

/// Columns from `begin` to before `end` are opaque, the rest is empty.
Image stripe(int width, int height, int begin, int end, float red) {
  Image image(width, height, 4);
  for (int y = 0; y < height; ++y) {
    for (int x = begin; x < end; ++x) {
      image.at(x, y)[0] = red;
      image.at(x, y)[3] = 1;
    }
  }
  return image;
}

TEST(WebpAnimation, ShowsEveryPictureForItsTime) {
  constexpr int kPictures = 5;
  WebpAnimation animation(20, 80);
  for (int i = 0; i < kPictures; ++i) {
    animation.add(stripe(40, 30, 8 * i, 8 * i + 8, 0.2f * static_cast<float>(i)));
  }
  const Bytes bytes = animation.finish();
  const WebPData data{bytes.data(), bytes.size()};
  WebPAnimDecoder* decoder = WebPAnimDecoderNew(&data, nullptr);
  ASSERT_NE(decoder, nullptr);
  WebPAnimInfo info;
  ASSERT_TRUE(WebPAnimDecoderGetInfo(decoder, &info));
  EXPECT_EQ(info.canvas_width, 40U);
  EXPECT_EQ(info.canvas_height, 30U);
  EXPECT_EQ(info.frame_count, 5U);
  EXPECT_EQ(info.loop_count, 0U);  // for ever
  for (int i = 0; WebPAnimDecoderHasMoreFrames(decoder) != 0; ++i) {
    std::uint8_t* rgba = nullptr;
    int end = 0;
    ASSERT_TRUE(WebPAnimDecoderGetNext(decoder, &rgba, &end));
    EXPECT_EQ(end, 50 * (i + 1));
    for (int x = 4; x < 40; x += 8) {
      EXPECT_EQ(rgba[4 * x + 3], x / 8 == i ? 255 : 0) << "picture " << i << " at " << x;
    }
    EXPECT_NEAR(rgba[4 * (8 * i + 4)], 51 * i, 8);
  }
  WebPAnimDecoderDelete(decoder);
}

TEST(WebpAnimation, RefusesNothingAndOtherSizes) {
  WebpAnimation animation(20, 80);
  EXPECT_THROW(animation.finish(), Error);
  animation.add(stripe(40, 30, 0, 40, 0));
  EXPECT_THROW(animation.add(stripe(30, 40, 0, 30, 0)), Error);
}

}  // namespace
}  // namespace clipgs
