#include <algorithm>
#include <array>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "core/random.h"
#include "volume/dicom_fixture.h"
#include "volume/load.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using testing::HasSubstr;

FixtureSlice tilted_slice(double degrees) {
  FixtureSlice slice;
  const double angle = glm::radians(degrees);
  slice.column = {0, std::cos(angle), -std::sin(angle)};
  return slice;
}

/// Inside the middle of the scan the volume equals the function it was sampled from.
void expect_truth(const Volume& volume, double tolerance) {
  int checked = 0;
  for (double x = 3; x < 12; x += 1.7) {
    for (double y = 3; y < 8; y += 1.3) {
      for (double z = -12; z < 0; z += 2.1) {
        const float value = volume.sample(Vec3(-x, -y, z));
        EXPECT_NEAR(value, fixture_truth({x, y, z}), tolerance) << x << " " << y << " " << z;
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 50);
}

TEST(Dicom, SeriesBecomesAVolumeInHu) {
  const TestFolder folder;
  FixtureSlice slice;
  slice.pixel_spacing = {1.25, 1.0};
  slice.slope = 0.5;
  slice.intercept = -1000;
  write_series(folder.path(), even_table(14, 2), slice);
  testing::internal::CaptureStderr();
  const Volume volume = load_volume(folder.path());
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(volume.modality, Modality::kCt);
  EXPECT_EQ(volume.dims, IVec3(16, 12, 14));
  EXPECT_LT(glm::length(volume.spacing - Vec3(1.25f, 1, 2)), 1e-4f);
  expect_truth(volume, 0.6);
}

TEST(Dicom, OneFileStandsForItsSeries) {
  const TestFolder folder;
  write_series(folder.path(), even_table(6, 2), FixtureSlice());
  EXPECT_EQ(load_volume(folder / "i7").dims, IVec3(16, 12, 6));
}

TEST(Dicom, ObliqueSeriesKeepsItsRotation) {
  const TestFolder folder;
  FixtureSlice slice = tilted_slice(12);
  const glm::dvec3 normal = glm::cross(slice.row, slice.column);
  for (int i = 0; i < 10; ++i) {
    slice.position = normal * (i * 2.0);
    slice.instance = i;
    fill(slice);
    write_dicom(folder / std::to_string(i), slice);
  }
  const Volume volume = load_volume(folder.path());
  EXPECT_EQ(volume.dims, IVec3(16, 12, 10));
  EXPECT_LT(glm::length(volume.direction[2] - Vec3(-normal.x, -normal.y, normal.z)), 1e-4f);
  EXPECT_NEAR(volume.sample(Vec3(-5, -5, 8)), fixture_truth({5, 5, 8}), 0.6);
}

TEST(Dicom, TiltedGantryIsResampledWithAWarning) {
  const TestFolder folder;
  write_series(folder.path(), even_table(14, 2), tilted_slice(16.5));
  testing::internal::CaptureStderr();
  const Volume volume = load_volume(folder.path());
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("gantry tilted by 16.5 degrees"));
  EXPECT_NEAR(volume.spacing.z, 2 * std::cos(glm::radians(16.5)), 1e-4);
  EXPECT_EQ(volume.values.range().min, -1024);  // outside
  expect_truth(volume, 0.7);
}

TEST(Dicom, UnevenSpacingIsResampledWithAWarning) {
  const TestFolder folder;
  write_series(folder.path(), {-20, -17, -14, -11, -6, -1, 4, 9}, FixtureSlice());
  testing::internal::CaptureStderr();
  const Volume volume = load_volume(folder.path());
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("slices 3.00 to 5.00 mm apart"));
  EXPECT_NEAR(volume.spacing.z, 3, 1e-4);
  expect_truth(volume, 0.7);
}

TEST(Dicom, AFewMissingSlicesAreInterpolatedWithAWarning) {
  const TestFolder folder;
  write_series(folder.path(), even_table(12, 2), FixtureSlice());
  std::filesystem::remove(folder / "i11");  // the seventh, at -8 mm: 6 * 7 % 31
  testing::internal::CaptureStderr();
  const Volume volume = load_volume(folder.path());
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              HasSubstr("1 of 12 slices is missing: slice 7 (at -8.00 mm); interpolated"));
  EXPECT_EQ(volume.dims, IVec3(16, 12, 12));
  EXPECT_NEAR(volume.spacing.z, 2, 1e-6);
  for (double z = -20; z <= 2; z += 2) {
    EXPECT_NEAR(volume.sample(Vec3(-3, -4, z)), fixture_truth({3, 4, z}), 0.6) << z;
  }
  LoadOptions strict;
  strict.gaps = Gaps::kRefuse;
  EXPECT_THAT(error_of([&] { load_volume(folder.path(), strict); }),
              HasSubstr("1 of 12 slices missing"));
}

TEST(Dicom, ManyMissingSlicesAreAnError) {
  const TestFolder folder;
  write_series(folder.path(), even_table(12, 2), FixtureSlice());
  std::filesystem::remove(folder / "i11");
  std::filesystem::remove(folder / "i18");
  EXPECT_THAT(error_of([&] { load_volume(folder.path()); }),
              HasSubstr("2 of 12 slices missing, the first after slice 6"));
}

TEST(Dicom, ModalityIsThatOfTheHeaderAndNothingElse) {
  const TestFolder folder;
  for (const auto& [term, modality] :
       {std::pair{"CT", Modality::kCt}, std::pair{"MR", Modality::kMr},
        std::pair{"PT", Modality::kPet}, std::pair{"US", Modality::kUltrasound}}) {
    FixtureSlice slice;
    slice.modality = term;
    write_series(folder / term, even_table(5, 2), slice);
    LoadOptions options;
    EXPECT_EQ(load_volume(folder / term, options).modality, modality);
    options.modality = modality;
    EXPECT_EQ(load_volume(folder / term, options).modality, modality);
    options.modality = modality == Modality::kMr ? Modality::kPet : Modality::kMr;
    EXPECT_THAT(error_of([&] { load_volume(folder / term, options); }),
                HasSubstr(std::string("its header says ") + modality_name(modality)));
  }
}

TEST(Dicom, HintsAreMatchedAndNoTextIsKept) {
  const TestFolder folder;
  FixtureSlice slice;
  slice.texts = {{0x0008, 0x103e, "CTA 0.75 Miller"},
                 {0x0018, 0x0010, "Iohexol for Miller"},
                 {0x0018, 0x0015, "HEADNECK"}};
  write_series(folder / "a", even_table(5, 2), slice);
  const Hints hints = load_volume(folder / "a").hints;
  EXPECT_EQ(hints.modality, Modality::kCt);
  EXPECT_EQ(hints.region, BodyRegion::kHead);
  EXPECT_EQ(hints.part, BodyPart::kHeadAndNeck);
  EXPECT_TRUE(hints.angiography);
  EXPECT_TRUE(hints.contrast);
  EXPECT_FALSE(hints.shown);
  write_series(folder / "b", even_table(5, 2), FixtureSlice());
  const Hints none = load_volume(folder / "b").hints;
  EXPECT_EQ(none.region, BodyRegion::kUnknown);
  EXPECT_EQ(none.part, BodyPart::kUnknown);
  EXPECT_FALSE(none.angiography || none.contrast);
}

TEST(Dicom, PartIsThatOfTheUserElseOfOneFieldOfTheHeader) {
  const TestFolder folder;
  FixtureSlice slice;
  slice.texts = {{0x0008, 0x103e, "HEAD"}, {0x0018, 0x0015, "KNEE"}};
  write_series(folder / "a", even_table(5, 2), slice);
  EXPECT_EQ(load_volume(folder / "a").part, BodyPart::kKnee);
  LoadOptions options;
  options.part = BodyPart::kFoot;
  EXPECT_EQ(load_volume(folder / "a", options).part, BodyPart::kFoot);
  slice.texts = {{0x0008, 0x103e, "HEAD"}, {0x0018, 0x0015, "KNEE Miller"}};
  write_series(folder / "b", even_table(5, 2), slice);
  EXPECT_EQ(load_volume(folder / "b").part, BodyPart::kUnknown);
}

TEST(Dicom, LargestSeriesIsTakenAndTheOthersListed) {
  const TestFolder folder;
  write_series(folder.path(), even_table(5, 2), FixtureSlice(), "a");
  FixtureSlice other;
  other.series_uid = "1.2.3.4";
  other.modality = "MR";
  write_series(folder.path(), even_table(9, 3), other, "b");
  testing::internal::CaptureStderr();
  EXPECT_EQ(load_volume(folder.path()).dims.z, 9);
  const std::string listing = testing::internal::GetCapturedStderr();
  EXPECT_THAT(listing, HasSubstr("1) MR, series 7, 9 slices of 16 x 12, UID 1.2.3.4"));
  EXPECT_THAT(listing, HasSubstr("2) CT"));

  LoadOptions options;
  options.series = "2";
  EXPECT_EQ(load_volume(folder.path(), options).dims.z, 5);
  options.series = "1.2.3.4";
  EXPECT_EQ(load_volume(folder.path(), options).modality, Modality::kMr);
  options.series = "9";
  EXPECT_THAT(error_of([&] { load_volume(folder.path(), options); }), HasSubstr("from 1 to 2"));
  options.series = "2";
  const std::vector<SeriesInfo> series = load_with_series(folder.path(), options).series;
  ASSERT_EQ(series.size(), 2);
  EXPECT_FALSE(series[0].taken);
  EXPECT_TRUE(series[1].taken);
}

TEST(Dicom, RepeatedPositionsKeepTheFirstInstance) {
  const TestFolder folder;
  write_series(folder.path(), even_table(5, 2), FixtureSlice(), "a");
  write_series(folder.path(), even_table(5, 2), FixtureSlice(), "b");
  testing::internal::CaptureStderr();
  EXPECT_EQ(load_volume(folder.path()).dims.z, 5);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("5 images share their position"));
}

/// The file with another value of a short element (explicit, little-endian).
std::vector<std::uint8_t> with_element(const std::vector<std::uint8_t>& file, std::uint16_t group,
                                       std::uint16_t element, const std::string& value) {
  const auto low = [](std::uint16_t n) { return static_cast<std::uint8_t>(n & 0xff); };
  const auto high = [](std::uint16_t n) { return static_cast<std::uint8_t>(n >> 8); };
  const std::array<std::uint8_t, 4> tag{low(group), high(group), low(element), high(element)};
  const auto found = std::ranges::search(file, tag).begin();
  const auto length = found + 6;
  const size_t old = static_cast<size_t>(length[0]) + 256 * static_cast<size_t>(length[1]);
  std::vector<std::uint8_t> result(file.begin(), length);
  result.push_back(low(static_cast<std::uint16_t>(value.size())));
  result.push_back(high(static_cast<std::uint16_t>(value.size())));
  result.insert(result.end(), value.begin(), value.end());
  result.insert(result.end(), length + 2 + static_cast<std::ptrdiff_t>(old), file.end());
  return result;
}

TEST(Dicom, NumbersMayBePaddedOneByOne) {
  const TestFolder folder;
  write_series(folder.path(), even_table(6, 2), FixtureSlice());
  const Volume plain = load_volume(folder.path());
  const std::vector<std::uint8_t> whole = read_file(folder / "i7");
  write_plainly(folder / "i7", with_element(whole, 0x0028, 0x0030, " 1 \\ 1  "));
  const Volume padded = load_volume(folder.path());
  EXPECT_EQ(padded.dims, plain.dims);
  EXPECT_EQ(padded.values, plain.values);
}

TEST(Dicom, WhatWouldGiveWrongValuesIsRefused) {
  const TestFolder folder;
  write_series(folder.path(), even_table(6, 2), FixtureSlice());
  const std::vector<std::uint8_t> whole = read_file(folder / "i7");
  const auto error = [&](std::uint16_t element, const std::string& value) {
    write_plainly(folder / "i7", with_element(whole, 0x0028, element, value));
    testing::internal::CaptureStderr();
    const std::string said = error_of([&] { load_volume(folder.path()); });
    return said + testing::internal::GetCapturedStderr();
  };
  EXPECT_THAT(error(0x1053, "1,25"), HasSubstr("a Rescale Slope that is no number"));
  EXPECT_THAT(error(0x1052, "-1O24 "), HasSubstr("a Rescale Intercept that is no number"));
  EXPECT_THAT(error(0x0102, std::string("\x0d\0", 2)), HasSubstr("the highest number 13"));
}

TEST(Dicom, PositionsFarApartWithinThePlanesAreRefused) {
  const TestFolder folder;
  write_series(folder.path(), even_table(6, 2), FixtureSlice());
  FixtureSlice astray;
  astray.position = {1e8, 0, -22};
  fill(astray);
  write_dicom(folder / "astray", astray);
  testing::internal::CaptureStderr();
  EXPECT_THAT(error_of([&] { load_volume(folder.path()); }),
              HasSubstr("its slices lie 1e+08 mm apart within their planes"));
  testing::internal::GetCapturedStderr();
}

TEST(Dicom, SlicesEachScaledInItsOwnWayAreKnownToNeedMoreMemory) {
  const TestFolder folder;
  FixtureSlice slice;
  slice.position.z = -22;
  fill(slice);
  write_dicom(folder / "first", slice);
  LoadOptions options;
  int stored_bytes = 0;
  options.work = [&](const VolumeSize& size) {
    stored_bytes = size.stored_bytes;
    return std::uint64_t{0};
  };
  write_series(folder.path(), even_table(6, 2), slice);
  load_volume(folder.path(), options);
  EXPECT_EQ(stored_bytes, 2);
  slice.slope = 0.5;
  write_series(folder.path(), even_table(6, 2), slice);
  load_volume(folder.path(), options);
  EXPECT_EQ(stored_bytes, 4);
}

TEST(Dicom, EmptyFilesOfASeriesAreMissed) {
  const TestFolder folder;
  write_series(folder.path(), even_table(6, 2), FixtureSlice());
  write_plainly(folder / "cut-off.dcm", {});
  EXPECT_THAT(error_of([&] { load_volume(folder.path()); }), HasSubstr("cut-off.dcm"));
}

TEST(Dicom, DamagedFilesAreErrors) {
  const TestFolder folder;
  write_series(folder.path(), even_table(6, 2), FixtureSlice());
  const std::vector<std::uint8_t> whole = read_file(folder / "i7");
  testing::internal::CaptureStderr();
  for (const size_t length : {size_t{140}, whole.size() / 2, whole.size() - 40}) {
    write_file(folder / "i7", whole.data(), length);
    const std::string error = error_of([&] { load_volume(folder.path()); });
    EXPECT_NE(error, "") << length;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
  testing::internal::GetCapturedStderr();
}

TEST(Dicom, FlippedBitsGiveAVolumeOrAnError) {
  const TestFolder folder;
  write_series(folder.path(), even_table(4, 2), FixtureSlice());
  const std::vector<std::uint8_t> whole = read_file(folder / "i7");
  Rng rng(3);
  testing::internal::CaptureStderr();
  for (int trial = 0; trial < 250; ++trial) {
    std::vector<std::uint8_t> bytes = whole;
    for (std::uint32_t flips = 1 + rng.below(4); flips > 0; --flips) {
      // Most of the file is pixels: aim at the header.
      bytes[132 + rng.below(700)] ^= static_cast<std::uint8_t>(1U << rng.below(8));
    }
    write_plainly(folder / "i7", bytes);
    try {
      const Volume volume = load_volume(folder.path());
      EXPECT_EQ(volume.values.size(), volume.voxels());
    } catch (const Error& e) {
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    }
  }
  testing::internal::GetCapturedStderr();
}

TEST(Dicom, OneSliceIsNoVolume) {
  const TestFolder folder;
  write_series(folder.path(), {0}, FixtureSlice());
  EXPECT_THAT(error_of([&] { load_volume(folder.path()); }), HasSubstr("at least 2"));
}

Volume load_real(const std::string& name, std::string& warnings) {
  testing::internal::CaptureStderr();
  Volume volume = load_volume(data_folder() / "dicom" / name);
  warnings = testing::internal::GetCapturedStderr();
  return volume;
}

TEST(RealDicom, FoldersLoad) {
  if (!std::filesystem::exists(data_folder() / "dicom")) {
    GTEST_SKIP() << "no real DICOM folders at " << data_folder();
  }
  std::string warnings;
  const Volume jpeg = load_real("jpeg2000", warnings);
  EXPECT_EQ(jpeg.dims, IVec3(512, 512, 20));
  EXPECT_EQ(jpeg.modality, Modality::kCt);
  EXPECT_EQ(jpeg.values.range().max, 1839);
  EXPECT_THAT(warnings, HasSubstr("took 169 ml of table"));
  const Volume tilted = load_real("tilted_gantry", warnings);
  EXPECT_EQ(tilted.dims.z, 24);
  EXPECT_THAT(warnings, HasSubstr("tilted by 16.5 degrees"));
  const Volume uneven = load_real("variable_spacing_tilted", warnings);
  EXPECT_NEAR(uneven.spacing.z, 4.0f, 0.01f);
  EXPECT_THAT(warnings, HasSubstr("tilted by 18.5 degrees and slices 1.08 to 7.00 mm apart"));
}

}  // namespace
}  // namespace clipgs
