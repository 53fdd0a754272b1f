#include "volume/dicom_series.h"

#include <gtest/gtest.h>

namespace clipgs {
namespace {

/// Slices whose positions along z are the running sum of `steps`.
std::vector<DicomHeader> headers_at(const std::vector<double>& steps) {
  std::vector<DicomHeader> slices;
  double z = 5;
  for (size_t i = 0; i <= steps.size(); ++i) {
    DicomHeader slice;
    slice.columns = slice.rows = 64;
    slice.placed = true;
    slice.position = {0, 0, z};
    slices.push_back(slice);
    z += i < steps.size() ? steps[i] : 0;
  }
  return slices;
}

TEST(Stacks, LocalizerOfTheSameSeriesStandsApart) {
  std::vector<DicomHeader> headers = headers_at({1, 1, 1});
  DicomHeader localizer = headers[0];
  localizer.row = {0, 1, 0};
  localizer.column = {0, 0, -1};
  headers.insert(headers.begin(), localizer);
  const std::vector<DicomStack> stacks = group_into_stacks(headers);
  ASSERT_EQ(stacks.size(), 2);
  EXPECT_EQ(stacks[0].slices.size(), 4);
}

TEST(Stacks, WhatIsDerivedFromPicturesComesAfterThem) {
  std::vector<DicomHeader> headers = headers_at({1, 1, 1});
  for (DicomHeader frame : headers_at({1, 1, 1, 1, 1, 1})) {
    frame.series_uid = "1.2.3";
    frame.modality = "SEG";
    headers.push_back(frame);
  }
  const std::vector<DicomStack> stacks = group_into_stacks(headers);
  ASSERT_EQ(stacks.size(), 2);
  EXPECT_EQ(stacks[0].modality, "");
  EXPECT_EQ(stacks[1].slices.size(), 7);
}

}  // namespace
}  // namespace clipgs
