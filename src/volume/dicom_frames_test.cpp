#include <algorithm>
#include <cstdint>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "core/random.h"
#include "volume/dicom_elements.h"
#include "volume/dicom_fixture.h"
#include "volume/load.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using testing::HasSubstr;

/// Filled slices along the table, in an order that is not theirs.
std::vector<FixtureSlice> slices_at(const std::vector<double>& table, double added = 0) {
  std::vector<FixtureSlice> slices;
  for (size_t i = 0; i < table.size(); ++i) {
    FixtureSlice slice;
    slice.slope = 0.5;
    slice.intercept = -1000;
    slice.pixel_spacing = {1.25, 1};
    slice.position.z = table[i * 5 % table.size()];
    fill(slice, added);
    slices.push_back(slice);
  }
  return slices;
}

/// A volume, or an error of one line.
void expect_sane_end(const std::filesystem::path& path) {
  testing::internal::CaptureStderr();
  const std::string error = error_of([&] { load_volume(path); });
  testing::internal::GetCapturedStderr();
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
}

TEST(DicomFrames, AFileOfFramesIsTheVolumeOfItsSlices) {
  const TestFolder folder;
  const std::vector<FixtureSlice> slices = slices_at(even_table(7, 2));
  std::filesystem::create_directories(folder / "series");
  for (size_t i = 0; i < slices.size(); ++i) {
    write_dicom(folder / "series" / std::to_string(i), slices[i]);
  }
  const Volume expected = load_volume(folder / "series");
  ASSERT_EQ(expected.dims, IVec3(16, 12, 7));
  for (const bool defined_lengths : {false, true}) {
    for (const bool rle : {false, true}) {
      write_frames(folder / "frames.dcm", slices, {defined_lengths, rle, {}});
      testing::internal::CaptureStderr();
      const Volume volume = load_volume(folder / "frames.dcm");
      EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
      EXPECT_EQ(volume.dims, expected.dims);
      EXPECT_EQ(volume.spacing, expected.spacing);
      EXPECT_EQ(volume.values, expected.values) << defined_lengths << rle;
      EXPECT_EQ(volume.modality, Modality::kCt);
    }
  }
}

TEST(DicomFrames, PhasesInOneFileAreToldApart) {
  const TestFolder folder;
  std::vector<FixtureSlice> slices = slices_at(even_table(6, 2));
  std::ranges::copy(slices_at(even_table(6, 2), 100), std::back_inserter(slices));
  write_frames(folder / "frames.dcm", slices, {false, false, {1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2}});
  testing::internal::CaptureStderr();
  const Volume first = load_volume(folder / "frames.dcm");
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("temporal position 2, 6 slices"));
  LoadOptions options;
  options.series = "2";
  const Volume second = load_volume(folder / "frames.dcm", options);
  ASSERT_EQ(second.dims, IVec3(16, 12, 6));
  EXPECT_NEAR(second.at(5, 5, 3) - first.at(5, 5, 3), 100, 1e-3);
}

TEST(DicomFrames, AMissingFrameIsInterpolated) {
  const TestFolder folder;
  std::vector<FixtureSlice> slices = slices_at(even_table(12, 2));
  std::erase_if(slices, [](const FixtureSlice& slice) { return slice.position.z == -8; });
  write_frames(folder / "frames.dcm", slices);
  testing::internal::CaptureStderr();
  EXPECT_EQ(load_volume(folder / "frames.dcm").dims.z, 12);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("slice 7 (at -8.00 mm)"));
}

/// A file of three frames that has one place only.
FixtureSlice three_frames() {
  FixtureSlice frames;
  frames.texts = {{0x0028, 0x0008, "3", true}};
  for (int frame = 0; frame < 3; ++frame) {
    FixtureSlice one;
    one.position.z = 3 * frame;
    fill(one);
    frames.pixels.insert(frames.pixels.end(), one.pixels.begin(), one.pixels.end());
  }
  return frames;
}

TEST(DicomFrames, DistancesBetweenFramesPlaceThem) {
  const TestFolder folder;
  FixtureSlice frames = three_frames();
  write_dicom(folder / "none.dcm", frames);
  EXPECT_THAT(error_of([&] { load_volume(folder / "none.dcm"); }), HasSubstr("position"));
  for (const FixtureSlice::Text& distances :
       {FixtureSlice::Text{0x0018, 0x0088, "3"}, FixtureSlice::Text{0x3004, 0x000c, "0\\3\\6"},
        FixtureSlice::Text{0x3004, 0x000c, "-9\\-6\\-3"}}) {
    frames.texts.resize(1);
    frames.texts.push_back(distances);
    write_dicom(folder / "frames.dcm", frames);
    const Volume volume = load_volume(folder / "frames.dcm");
    EXPECT_EQ(volume.spacing, Vec3(1, 1, 3)) << distances.value;
    EXPECT_NEAR(volume.sample(Vec3(-4, -3, 6)), fixture_truth({4, 3, 6}), 0.01);
  }
  frames.texts.back().value = "0\\3";
  write_dicom(folder / "frames.dcm", frames);
  EXPECT_THAT(error_of([&] { load_volume(folder / "frames.dcm"); }), HasSubstr("position"));
}

TEST(DicomFrames, FramesCountedByTimeHaveNoPlaces) {
  const TestFolder folder;
  FixtureSlice frames = three_frames();
  frames.texts.push_back({0x0018, 0x0088, "3"});
  frames.texts.push_back({0x0028, 0x0009, std::string("\x54\0\x80\0", 4)});  // slices
  write_dicom(folder / "frames.dcm", frames);
  EXPECT_EQ(load_volume(folder / "frames.dcm").dims.z, 3);
  frames.texts.back().value = std::string("\x54\0\x70\0", 4);  // time slots
  write_dicom(folder / "frames.dcm", frames);
  EXPECT_THAT(error_of([&] { load_volume(folder / "frames.dcm"); }), HasSubstr("position"));
}

TEST(DicomFrames, DosesHaveAScaleOfTheirOwn) {
  const TestFolder folder;
  FixtureSlice frames = three_frames();
  frames.texts.push_back({0x3004, 0x000c, "0\\3\\6"});
  write_dicom(folder / "ct.dcm", frames);
  const Volume plain = load_volume(folder / "ct.dcm");
  frames.modality = "RTDOSE";
  frames.intercept = 0;
  frames.texts.push_back({0x3004, 0x000e, "0.25"});
  write_dicom(folder / "dose.dcm", frames);
  const Volume dose = load_volume(folder / "dose.dcm");
  EXPECT_NEAR(dose.at(5, 5, 1), 0.25f * (plain.at(5, 5, 1) + 1024), 1e-3);
}

TEST(DicomFrames, AnUnknownCompressionIsNotCalledCorrupt) {
  const TestFolder folder;
  write_frames(folder / "frames.dcm", slices_at(even_table(6, 2)), {false, true, {}});
  std::vector<std::uint8_t> bytes = read_file(folder / "frames.dcm");
  constexpr std::string_view kRle = "1.2.840.10008.1.2.5";
  const auto found = std::ranges::search(bytes, kRle);
  ASSERT_FALSE(found.empty());
  *(found.end() - 1) = '9';
  write_file(folder / "frames.dcm", bytes.data(), bytes.size());
  EXPECT_THAT(error_of([&] { load_volume(folder / "frames.dcm"); }),
              HasSubstr("compression 1.2.840.10008.1.2.9 is not supported"));
}

/// Replaces the type of the element with this tag.
void set_type(std::vector<std::uint8_t>& bytes, const std::vector<std::uint8_t>& tag,
              std::string_view type) {
  const auto found = std::ranges::search(bytes, tag);
  ASSERT_NE(found.begin(), bytes.end());
  std::ranges::copy(type, found.begin() + 4);
}

TEST(DicomFrames, WrongTypesOfElementsEndNothing) {
  const TestFolder folder;
  write_frames(folder / "whole.dcm", slices_at(even_table(4, 2)), {false, true, {}});
  const std::vector<std::uint8_t> whole = read_file(folder / "whole.dcm");
  for (const std::vector<std::uint8_t>& tag : std::vector<std::vector<std::uint8_t>>{
           {0x28, 0, 8, 0}, {0x28, 0, 0x10, 0}, {0x20, 0, 0x32, 0}, {0x28, 0, 0x53, 0x10}}) {
    for (const std::string_view type : {"US", "FD", "UN", "SQ", "OB", "XX", "zz"}) {
      std::vector<std::uint8_t> bytes = whole;
      set_type(bytes, tag, type);
      write_plainly(folder / "frames.dcm", bytes);
      expect_sane_end(folder / "frames.dcm");
    }
  }
}

TEST(DicomFrames, FlippedBitsGiveAVolumeOrAnError) {
  const TestFolder folder;
  Rng rng(5);
  for (const bool defined_lengths : {false, true}) {
    write_frames(folder / "whole.dcm", slices_at(even_table(4, 2)), {defined_lengths, true, {}});
    const std::vector<std::uint8_t> whole = read_file(folder / "whole.dcm");
    for (int trial = 0; trial < 300; ++trial) {
      std::vector<std::uint8_t> bytes = whole;
      for (std::uint32_t flips = 1 + rng.below(3); flips > 0; --flips) {
        bytes[132 + rng.below(static_cast<std::uint32_t>(bytes.size()) - 132)] ^=
            static_cast<std::uint8_t>(1U << rng.below(8));
      }
      write_plainly(folder / "frames.dcm", bytes);
      expect_sane_end(folder / "frames.dcm");
    }
  }
}

void put(std::vector<std::uint8_t>& bytes, std::initializer_list<std::uint32_t> shorts) {
  for (const std::uint32_t number : shorts) {
    bytes.push_back(static_cast<std::uint8_t>(number & 0xffU));
    bytes.push_back(static_cast<std::uint8_t>(number >> 8U));
  }
}

TEST(DicomElements, TheTableOfOffsetsSaysWhosePiecesAre) {
  std::vector<std::uint8_t> bytes(128, 0);
  put(bytes, {0x4944, 0x4d43});                             // DICM
  put(bytes, {0x7fe0, 0x0010, 0x424f, 0, 0xffff, 0xffff});  // pixels, OB
  const auto item = [&](std::uint32_t size) { put(bytes, {0xfffe, 0xe000, size, 0}); };
  item(8);
  put(bytes, {0, 0, 20, 0});  // the second frame begins with the third piece
  for (const std::uint32_t piece : {1U, 2U, 3U}) {
    item(2);
    put(bytes, {piece});
  }
  put(bytes, {0xfffe, 0xe0dd, 0, 0});
  DicomElements elements(bytes, "x");
  elements.walk();
  const auto first = elements.fragments(0, 2);
  const auto second = elements.fragments(1, 2);
  ASSERT_EQ(first.size(), 2);
  ASSERT_EQ(second.size(), 1);
  EXPECT_EQ(first[1][0], 2);
  EXPECT_EQ(second[0][0], 3);
  EXPECT_EQ(elements.fragments(0, 1).size(), 3);
  EXPECT_EQ(elements.fragments(2, 3)[0][0], 3);
  EXPECT_THAT(error_of([&] { elements.fragments(0, 4); }), HasSubstr("fewer pieces"));
}

}  // namespace
}  // namespace clipgs
