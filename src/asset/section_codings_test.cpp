#include "asset/section_codings.h"

#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>

#include "asset/section_file.h"
#include "section/test_section.h"

namespace clipgs {
namespace {

/// Waves and noise: an image that takes less with every step of quality.
Section textured_section() {
  Section section = test::ball_section();
  section.dims = {48, 40, 50};
  section.voxels.resize(size_t{48} * 40 * 50);
  std::mt19937 random(3);
  for (int z = 0; z < section.dims.z; ++z) {
    for (int y = 0; y < section.dims.y; ++y) {
      for (int x = 0; x < section.dims.x; ++x) {
        const double wave = 60 * std::sin(0.3 * x) * std::cos(0.2 * y + 0.1 * z);
        const double noise = static_cast<double>(random() % 32);
        section.voxels[section.offset(x, y, z)] =
            static_cast<std::uint8_t>(std::lround(120 + wave + noise));
      }
    }
  }
  return section;
}

TEST(SectionCodings, TheBestThatFitsIsFoundAsIfAllWereTried) {
  const Section section = textured_section();
  std::vector<size_t> all;  // ever smaller
  for (const float quality : {kLossless, 97.0f, 94.0f, 90.0f, 85.0f, 80.0f, 75.0f, 70.0f}) {
    all.push_back(SectionCodings(section, quality, Saving::kBytes).best(0).bytes());
  }
  ASSERT_TRUE(std::ranges::is_sorted(all, std::ranges::greater()));
  SectionCodings codings(section, {}, Saving::kBytes);
  for (size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(codings.best(all[i]).bytes(), all[i]);
    EXPECT_EQ(codings.best(all[i] - 1).bytes(), all[std::min(i + 1, all.size() - 1)]);
  }
}

TEST(SectionCodings, AQualityThatIsGivenIsKeptWhateverItTakes) {
  const Section section = textured_section();
  SectionCodings codings(section, 90, Saving::kTime);
  EXPECT_EQ(codings.best(0).file.bytes, codings.best(1'000'000).file.bytes);
}

}  // namespace
}  // namespace clipgs
