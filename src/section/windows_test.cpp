#include "section/windows.h"

#include <gtest/gtest.h>
#include <numeric>
#include <string>

namespace clipgs {
namespace {

/// One voxel of each code, and as much air around them; the value of a code is 10 times it.
Section of_all_codes(Modality modality) {
  Section section;
  section.modality = modality;
  section.dims = {16, 16, 2};
  section.voxels.resize(section.voxel_count());
  std::iota(section.voxels.begin(), section.voxels.begin() + 256, std::uint8_t{0});
  std::vector<float> values(ValueCurve::kCodes);
  for (size_t code = 0; code < values.size(); ++code) {
    values[code] = 10 * static_cast<float>(code);
  }
  section.curve = ValueCurve(values);
  return section;
}

TEST(Windows, OfACtAreInHu) {
  const std::vector<NamedWindow> windows = windows_of(of_all_codes(Modality::kCt));
  ASSERT_EQ(windows.size(), kCtWindows.size());
  EXPECT_EQ(windows[0].name, std::string("soft-tissue"));
  EXPECT_EQ(windows[2].window.center, -600);
}

TEST(Windows, OfOthersFollowTheValues) {
  for (const Modality modality : {Modality::kMr, Modality::kPet, Modality::kUnknown}) {
    const std::vector<NamedWindow> windows = windows_of(of_all_codes(modality));
    ASSERT_EQ(windows.size(), 2U);
    EXPECT_EQ(windows[0].name, std::string("auto"));
    // 1 % of the 240 codes from 16 on are the first 2.4 of them: codes 18 to 253.
    EXPECT_EQ(windows[0].window.center, 10 * 0.5f * (18 + 253));
    EXPECT_EQ(windows[0].window.width, 10 * (253 - 18));
    EXPECT_EQ(windows[1].name, std::string("full"));
    EXPECT_EQ(windows[1].window.center, 10 * 0.5f * (16 + 255));
    EXPECT_EQ(windows[1].window.width, 10 * (255 - 16));
  }
}

TEST(Windows, ShowSomethingOfOneValueOrNothing) {
  Section section = of_all_codes(Modality::kMr);
  for (const std::uint8_t code : {0, 100, 255}) {
    std::ranges::fill(section.voxels, code);
    EXPECT_GT(windows_of(section)[0].window.width, 0) << int{code};
  }
}

TEST(Windows, PhotographsHaveNone) {
  Section section = of_all_codes(Modality::kPhoto);
  section.channels = 3;
  EXPECT_TRUE(windows_of(section).empty());
}

}  // namespace
}  // namespace clipgs
