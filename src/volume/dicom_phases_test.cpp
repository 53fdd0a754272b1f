#include "volume/dicom_phases.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "volume/dicom_fixture.h"
#include "volume/dicom_series.h"
#include "volume/load.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct PhaseImage {
  double z = 0;
  DicomMarks marks;
};

/// Sorted as a stack is.
std::vector<DicomPhase> phases_of(std::vector<PhaseImage> images) {
  std::ranges::stable_sort(images, {}, &PhaseImage::z);
  std::vector<DicomHeader> slices;
  for (const PhaseImage& image : images) {
    DicomHeader slice;
    slice.columns = slice.rows = 64;
    slice.placed = true;
    slice.position = {0, 0, image.z};
    slice.marks = image.marks;
    slices.push_back(slice);
  }
  return split_phases(slices);
}

DicomMarks acquisition(double number) { return {.acquisition = number}; }

std::vector<std::string> names(const std::vector<DicomPhase>& phases) {
  std::vector<std::string> list;
  for (const DicomPhase& phase : phases) {
    list.push_back(fmt::format("{}: {}", phase.name, phase.slices.size()));
  }
  return list;
}

TEST(DicomPhases, WhatRepeatsNoPlaceStaysWhole) {
  std::vector<PhaseImage> images;
  for (int z = 0; z < 10; ++z) {
    images.push_back({1.0 * z, {.trigger_ms = 7.0 * z, .acquisition = z, .acquired_s = 2.0 * z}});
  }
  EXPECT_THAT(names(phases_of(images)), ElementsAre(": 10"));
}

TEST(DicomPhases, CopiesStayTogether) {
  std::vector<PhaseImage> images;
  for (int i = 0; i < 20; ++i) {
    images.push_back({1.0 * (i / 2), {.echo_ms = 3, .acquisition = 1, .image_type = "A"}});
  }
  EXPECT_THAT(names(phases_of(images)), ElementsAre(": 20"));
}

TEST(DicomPhases, ContrastPhasesOfDifferentExtentAreNotMixed) {
  std::vector<PhaseImage> images;
  for (int z = 0; z < 30; ++z) {
    images.push_back({1.0 * z, acquisition(4)});
    if (z >= 10 && z < 20) {
      images.push_back({1.0 * z, acquisition(3)});
    }
  }
  EXPECT_THAT(names(phases_of(images)), ElementsAre("acquisition 3: 10", "acquisition 4: 30"));
}

TEST(DicomPhases, ABolusMonitoredAtOnePlaceIsNoPartOfTheScan) {
  std::vector<PhaseImage> images;
  for (int i = 0; i < 40; ++i) {
    images.push_back({12, acquisition(1)});
    images.push_back({1.0 * i, acquisition(2)});
  }
  EXPECT_THAT(names(phases_of(images)), ElementsAre("acquisition 1: 40", "acquisition 2: 40"));
}

TEST(DicomPhases, BlocksThatOverlapByAFewSlicesAreOneScan) {
  std::vector<PhaseImage> images;
  for (int z = 0; z < 30; ++z) {
    images.push_back({1.0 * z, acquisition(1)});
    images.push_back({1.0 * z + 27, acquisition(2)});
  }
  EXPECT_THAT(names(phases_of(images)), ElementsAre(": 60"));
}

TEST(DicomPhases, TriggerTimesOfACineDifferFromSliceToSlice) {
  std::vector<PhaseImage> images;
  for (int z = 0; z < 8; ++z) {
    for (int phase = 0; phase < 5; ++phase) {
      images.push_back({1.0 * z, {.trigger_ms = phase * (40 + z), .acquisition = z}});
    }
  }
  const std::vector<DicomPhase> phases = phases_of(images);
  EXPECT_THAT(names(phases),
              ElementsAre("trigger time 0 ms: 8", "phase 2 of 5 (trigger time 40 to 47 ms): 8",
                          "phase 3 of 5 (trigger time 80 to 94 ms): 8",
                          "phase 4 of 5 (trigger time 120 to 141 ms): 8",
                          "phase 5 of 5 (trigger time 160 to 188 ms): 8"));
  for (size_t phase = 0; phase < phases.size(); ++phase) {
    for (const DicomHeader& slice : phases[phase].slices) {
      EXPECT_EQ(slice.marks.trigger_ms, static_cast<double>(phase) * (40 + slice.position.z));
    }
  }
}

TEST(DicomPhases, AcquisitionsCountedSliceBySliceAreInTheirOrder) {
  std::vector<PhaseImage> images;
  for (int z = 0; z < 6; ++z) {
    for (int pass = 0; pass < 3; ++pass) {
      images.push_back({1.0 * z, acquisition(1 + z + 6 * pass)});
    }
  }
  EXPECT_THAT(names(phases_of(images)), ElementsAre("phase 1 of 3 (acquisition 1 to 6): 6",
                                                    "phase 2 of 3 (acquisition 7 to 12): 6",
                                                    "phase 3 of 3 (acquisition 13 to 18): 6"));
}

TEST(DicomPhases, SeveralPropertiesSplitOneAfterTheOther) {
  std::vector<PhaseImage> images;
  for (int z = 0; z < 4; ++z) {
    for (const double echo : {4.5, 2.25}) {
      for (const char* type : {"P", "M"}) {
        images.push_back({1.0 * z, {.echo_ms = echo, .image_type = type}});
      }
    }
  }
  EXPECT_THAT(
      names(phases_of(images)),
      ElementsAre("echo time 2.25 ms, image type M: 4", "echo time 2.25 ms, image type P: 4",
                  "echo time 4.5 ms, image type M: 4", "echo time 4.5 ms, image type P: 4"));
}

TEST(DicomPhases, EveryPropertySetsImagesApart) {
  const std::vector<std::pair<DicomMarks, DicomMarks>> pairs = {
      {{.temporal_position = 1}, {.temporal_position = 2}},
      {{.temporal_index = 1}, {.temporal_index = 2}},
      {{.trigger_ms = 1}, {.trigger_ms = 2}},
      {{.echo_ms = 1}, {.echo_ms = 2}},
      {{}, {.b_value = 800}},
      {{.acquisition = 1}, {.acquisition = 2}},
      {{.acquired_s = 100}, {.acquired_s = 104.5}},
      {{.image_type = "A"}, {.image_type = "B"}}};
  for (const auto& [first, second] : pairs) {
    std::vector<PhaseImage> images;
    for (int z = 0; z < 5; ++z) {
      images.push_back({1.0 * z, second});
      images.push_back({1.0 * z, first});
    }
    const std::vector<DicomPhase> phases = phases_of(images);
    ASSERT_EQ(phases.size(), 2);
    EXPECT_EQ(phases[0].slices.size(), 5) << phases[0].name;
    EXPECT_NE(phases[0].name, phases[1].name);
  }
}

/// Two phases of one series, the second 100 HU brighter; their instance numbers are interleaved.
void write_phases(const TestFolder& folder, const FixtureSlice::Text& first,
                  const FixtureSlice::Text& second) {
  FixtureSlice slice;
  slice.texts = {second};
  write_series(folder.path(), even_table(5, 2), slice, "b", 100);
  slice.texts = {first};
  write_series(folder.path(), even_table(5, 2), slice, "a");
}

TEST(DicomPhases, EachIsAVolumeToChoose) {
  const std::vector<std::array<FixtureSlice::Text, 2>> differences = {
      {{{0x0020, 0x0012, "2"}, {0x0020, 0x0012, "3"}}},              // acquisition number
      {{{0x0020, 0x0100, "1"}, {0x0020, 0x0100, "2"}}},              // temporal position
      {{{0x0018, 0x1060, "0"}, {0x0018, 0x1060, "412.5"}}},          // trigger time
      {{{0x0018, 0x0081, "4.76"}, {0x0018, 0x0081, "9.5"}}},         // echo time
      {{{0x0008, 0x0032, "095959.5"}, {0x0008, 0x0032, "100001"}}},  // acquisition time
      {{{0x0008, 0x0008, "A\\M"}, {0x0008, 0x0008, "A\\P"}}}};       // image type
  const std::vector<std::string> told = {
      "1) CT, series 7, acquisition 2, 5 slices",
      "temporal position 2, 5 slices",
      "trigger time 412.5 ms",
      "echo time 4.76 ms",
      "acquired 0 s after the first, 5 slices of 16 x 12, UID 1.2.826.0.1.3680043.2.1125.1; 2) CT, "
      "series 7, acquired 1.5 s after",
      "image type A\\P"};
  for (size_t i = 0; i < told.size(); ++i) {
    const TestFolder folder;
    write_phases(folder, differences[i][0], differences[i][1]);
    const double middle = fixture_truth({3, 4, -16});
    testing::internal::CaptureStderr();
    const LoadedVolume first = load_with_series(folder.path());
    const std::string warnings = testing::internal::GetCapturedStderr();
    EXPECT_THAT(warnings, HasSubstr(told[i]));
    EXPECT_THAT(warnings, HasSubstr("taking 1, choose another with --series"));
    EXPECT_NEAR(first.volume.sample(Vec3(-3, -4, -16)), middle, 0.6) << told[i];
    ASSERT_EQ(first.series.size(), 2);
    EXPECT_TRUE(first.series[0].taken);
    testing::internal::CaptureStderr();
    LoadOptions options;
    options.series = "2";
    EXPECT_NEAR(load_volume(folder.path(), options).sample(Vec3(-3, -4, -16)), middle + 100, 0.6);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    // One file stands for its phase.
    testing::internal::CaptureStderr();
    EXPECT_NEAR(load_volume(folder / "b7").sample(Vec3(-3, -4, -16)), middle + 100, 0.6);
    EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("taking 2"));
  }
}

TEST(DicomPhases, StationsBesideOneAnotherAreNotCopies) {
  const TestFolder folder;
  FixtureSlice slice;
  write_series(folder.path(), even_table(5, 2), slice, "a");
  slice.position.y = 9;
  write_series(folder.path(), even_table(5, 2), slice, "b");
  LoadOptions options;
  for (const double y : {0.0, 9.0}) {
    testing::internal::CaptureStderr();
    const Volume volume = load_volume(folder.path(), options);
    EXPECT_THAT(testing::internal::GetCapturedStderr(),
                y == 0 ? HasSubstr("front-to-back position 9 mm, 5 slices") : HasSubstr(""));
    EXPECT_NEAR(volume.sample(Vec3(-3, -4 - y, -16)), fixture_truth({3, 4 + y, -16}), 0.6);
    options.series = "2";
  }
}

TEST(DicomPhases, AUidNamesTheFirstAndSaysSo) {
  const TestFolder folder;
  write_phases(folder, {0x0020, 0x0012, "2"}, {0x0020, 0x0012, "3"});
  LoadOptions options;
  options.series = FixtureSlice().series_uid;
  testing::internal::CaptureStderr();
  EXPECT_NEAR(load_volume(folder.path(), options).sample(Vec3(-3, -4, -16)),
              fixture_truth({3, 4, -16}), 0.6);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("taking 1"));
}

}  // namespace
}  // namespace clipgs
