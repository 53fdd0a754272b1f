#include <algorithm>
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

/// A function that linear resampling keeps: HU at an LPS position.
double truth(const glm::dvec3& lps) { return 40 + 3 * lps.x - 2 * lps.y + 4 * lps.z; }

void fill(FixtureSlice& slice) {
  for (int y = 0; y < slice.rows; ++y) {
    for (int x = 0; x < slice.columns; ++x) {
      const glm::dvec3 p = slice.position + slice.row * (x * slice.pixel_spacing.x) +
                           slice.column * (y * slice.pixel_spacing.y);
      slice.pixels.push_back(
          static_cast<std::int16_t>(std::lround((truth(p) - slice.intercept) / slice.slope)));
    }
  }
}

/// Writes one slice per position along the table (z), in an order that names do not follow.
void write_series(const TestFolder& folder, const std::vector<double>& table, FixtureSlice slice,
                  const std::string& prefix = "i") {
  for (size_t i = 0; i < table.size(); ++i) {
    slice.pixels.clear();
    slice.position.z = table[i];
    slice.instance = static_cast<int>(i) + 1;
    fill(slice);
    write_dicom(folder / fmt::format("{}{}", prefix, (i * 7) % 31), slice);
  }
}

std::vector<double> even_table(int slices, double step) {
  std::vector<double> table;
  for (int i = 0; i < slices; ++i) {
    table.push_back(-20 + i * step);
  }
  return table;
}

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
        EXPECT_NEAR(value, truth({x, y, z}), tolerance) << x << " " << y << " " << z;
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
  write_series(folder, even_table(14, 2), slice);
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
  write_series(folder, even_table(6, 2), FixtureSlice());
  EXPECT_EQ(load_volume(folder / "i7").dims, IVec3(16, 12, 6));
}

TEST(Dicom, ObliqueSeriesKeepsItsRotation) {
  const TestFolder folder;
  FixtureSlice slice = tilted_slice(12);
  const glm::dvec3 normal = glm::cross(slice.row, slice.column);
  for (int i = 0; i < 10; ++i) {
    slice.pixels.clear();
    slice.position = normal * (i * 2.0);
    slice.instance = i;
    fill(slice);
    write_dicom(folder / std::to_string(i), slice);
  }
  const Volume volume = load_volume(folder.path());
  EXPECT_EQ(volume.dims, IVec3(16, 12, 10));
  EXPECT_LT(glm::length(volume.direction[2] - Vec3(-normal.x, -normal.y, normal.z)), 1e-4f);
  EXPECT_NEAR(volume.sample(Vec3(-5, -5, 8)), truth({5, 5, 8}), 0.6);
}

TEST(Dicom, TiltedGantryIsResampledWithAWarning) {
  const TestFolder folder;
  write_series(folder, even_table(14, 2), tilted_slice(16.5));
  testing::internal::CaptureStderr();
  const Volume volume = load_volume(folder.path());
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("gantry tilted by 16.5 degrees"));
  EXPECT_NEAR(volume.spacing.z, 2 * std::cos(glm::radians(16.5)), 1e-4);
  EXPECT_EQ(*std::min_element(volume.values.begin(), volume.values.end()), -1024);  // outside
  expect_truth(volume, 0.7);
}

TEST(Dicom, UnevenSpacingIsResampledWithAWarning) {
  const TestFolder folder;
  write_series(folder, {-20, -17, -14, -11, -6, -1, 4, 9}, FixtureSlice());
  testing::internal::CaptureStderr();
  const Volume volume = load_volume(folder.path());
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("slices 3.00 to 5.00 mm apart"));
  EXPECT_NEAR(volume.spacing.z, 3, 1e-4);
  expect_truth(volume, 0.7);
}

TEST(Dicom, MissingSlicesAreAnError) {
  const TestFolder folder;
  write_series(folder, even_table(12, 2), FixtureSlice());
  std::filesystem::remove(folder / "i11");  // the sixth: 5 * 7 % 31 = 4; i11 is the seventh
  const std::string error = error_of([&] { load_volume(folder.path()); });
  EXPECT_THAT(error, HasSubstr("1 of 12 slices missing"));
}

TEST(Dicom, LargestSeriesIsTakenAndTheOthersListed) {
  const TestFolder folder;
  write_series(folder, even_table(5, 2), FixtureSlice(), "a");
  FixtureSlice other;
  other.series_uid = "1.2.3.4";
  other.modality = "MR";
  write_series(folder, even_table(9, 3), other, "b");
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
  EXPECT_EQ(list_series(folder.path()).size(), 2);
}

TEST(Dicom, RepeatedPositionsKeepTheFirstInstance) {
  const TestFolder folder;
  write_series(folder, even_table(5, 2), FixtureSlice(), "a");
  write_series(folder, even_table(5, 2), FixtureSlice(), "b");
  testing::internal::CaptureStderr();
  EXPECT_EQ(load_volume(folder.path()).dims.z, 5);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("5 images share their position"));
}

TEST(Dicom, DamagedFilesAreErrors) {
  const TestFolder folder;
  write_series(folder, even_table(6, 2), FixtureSlice());
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
  write_series(folder, even_table(4, 2), FixtureSlice());
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
  write_series(folder, {0}, FixtureSlice());
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
  EXPECT_EQ(*std::max_element(jpeg.values.begin(), jpeg.values.end()), 1839);
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
