#include "volume/padding.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vector>

#include "core/random.h"
#include "volume/dicom_fixture.h"
#include "volume/load.h"
#include "volume/phantom.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using testing::HasSubstr;

bool is_outside_of_circle(const Volume& volume, size_t i) {
  const auto width = static_cast<size_t>(volume.dims.x);
  const Vec2 place(i % width, i / width % static_cast<size_t>(volume.dims.y));
  return glm::length(place - 0.5f * Vec2(volume.dims.x - 1, volume.dims.y - 1)) >
         0.5f * static_cast<float>(volume.dims.x);
}

/// A ball in noisy surroundings, and `padding` outside of the circle that a scanner reconstructs.
Volume padded(float inside, float outside, float padding, Modality modality) {
  Volume volume = make_ball(40, 12, inside, outside);
  volume.modality = modality;
  Rng rng(5);
  std::vector<float>& values = volume.values.unpack();
  for (size_t i = 0; i < values.size(); ++i) {
    values[i] = is_outside_of_circle(volume, i) ? padding : values[i] + std::abs(9 * rng.normal());
  }
  values[volume.offset(20, 20, 20)] = padding;  // amid the picture: metal, or a lack of signal
  return volume;
}

struct Case {
  float inside, outside, padding;
  Modality modality;
  float expected;
};

class Paddings : public testing::TestWithParam<Case> {};

TEST_P(Paddings, BecomeAirOrBackground) {
  const Case& is = GetParam();
  Volume volume = padded(is.inside, is.outside, is.padding, is.modality);
  const Volume before = volume;
  const std::optional<Padding> found = remove_padding(volume);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->value, is.padding);
  size_t outside = 0;
  for (size_t i = 0; i < volume.voxels(); ++i) {
    // A lowest value means the same everywhere; a highest one may be metal.
    const bool out =
        is_outside_of_circle(volume, i) || (is.padding < 0 && before.values[i] == is.padding);
    ASSERT_EQ(volume.values[i], out ? is.expected : before.values[i]) << i;
    outside += out ? 1 : 0;
  }
  EXPECT_EQ(found->voxels, outside);
}

constexpr Modality kCt = Modality::kCt;
constexpr Modality kMr = Modality::kMr;
constexpr Modality kAny = Modality::kUnknown;
INSTANTIATE_TEST_SUITE_P(
    Of, Paddings,
    testing::Values(Case{40, -1000, -2000, kCt, -1024}, Case{40, -1000, -3024, kAny, -1024},
                    Case{40, -1000, -2048, kAny, -1024}, Case{40, -1000, -32768, kAny, -1024},
                    Case{40, -1000, 32767, kAny, -1024}, Case{40, -1000, 3071, kCt, -1024},
                    Case{300, 5, -32768, kMr, 0}, Case{300, -600, -32768, kMr, 0},
                    Case{300, 5, 65535, kAny, 0}));

TEST(Padding, IsNotWhatABackgroundHas) {
  const auto expect_none = [](Volume volume) {
    const VoxelValues before = volume.values;
    EXPECT_FALSE(remove_padding(volume));
    EXPECT_EQ(volume.values, before);
  };
  expect_none(padded(40, -1000, -1024, kCt));  // air
  expect_none(padded(300, 60, 0, kMr));        // no signal
  expect_none(padded(100, 255, 280, kAny));    // a white background
  expect_none(padded(100, -600, 250, kMr));    // so low is no air, nor 250 too high for it
  Volume two_values;
  two_values.dims = {8, 8, 8};
  std::vector<float> values(512, 20);
  values[200] = 10;
  two_values.values = std::move(values);
  expect_none(two_values);
  expect_none(make_phantom(48));
}

TEST(Padding, OfAFileIsTold) {
  const TestFolder folder;
  save_volume(folder / "v.nrrd", padded(40, -1000, -32768, kAny));
  testing::internal::CaptureStderr();
  const LoadedVolume loaded = load_with_series(folder / "v.nrrd");
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("-32768 outside the picture"));
  EXPECT_EQ(loaded.volume.modality, Modality::kCt);
  EXPECT_EQ(loaded.volume.values[0], -1024);
  ASSERT_FALSE(loaded.prepared.empty());
  EXPECT_EQ(loaded.prepared.front().name, "padding");
}

/// The values of the corners of a CT whose first two pixels of a row are stored as `padding`.
float of_padded_dicom(const TestFolder& folder, std::int16_t padding,
                      std::optional<std::int16_t> limit, std::int16_t stored) {
  const std::filesystem::path series = folder / "series";
  std::filesystem::remove_all(series);
  std::filesystem::create_directories(series);
  FixtureSlice slice;
  slice.padding = padding;
  slice.padding_limit = limit;
  for (int i = 0; i < 4; ++i) {
    slice.position.z = 2 * i;
    slice.instance = i;
    fill(slice);
    slice.pixels[0] = slice.pixels[1] = stored;
    write_dicom(series / std::to_string(i), slice);
  }
  const Volume volume = load_volume(series);
  // The first pixel is the rightmost and foremost: x runs to the patient's left, y to the back.
  return volume.at(volume.dims.x - 1, volume.dims.y - 1, 0);
}

TEST(Padding, OfDicomIsWhatItsHeaderSays) {
  const TestFolder folder;
  EXPECT_EQ(of_padded_dicom(folder, 4000, std::nullopt, 4000 + 24), 3000);  // another value
  EXPECT_EQ(of_padded_dicom(folder, 4096, std::nullopt, 4096), -1024);
  EXPECT_EQ(of_padded_dicom(folder, 5000, 4096, 4500), -1024);
  EXPECT_EQ(of_padded_dicom(folder, 4096, 5000, 4500), -1024);
  EXPECT_EQ(of_padded_dicom(folder, 1064, std::nullopt, 1064), 40);  // tissue: not believed
}

}  // namespace
}  // namespace clipgs
