#include "volume/dicom_series.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using testing::HasSubstr;

/// Slices whose positions along z are the running sum of `steps`, shifted by `shear` mm a mm in y.
std::vector<DicomHeader> slices_at(const std::vector<double>& steps, double shear = 0) {
  std::vector<DicomHeader> slices;
  double z = 5;
  for (size_t i = 0; i <= steps.size(); ++i) {
    DicomHeader slice;
    slice.columns = slice.rows = 64;
    slice.placed = true;
    slice.position = {0, shear * z, z};
    slices.push_back(slice);
    z += i < steps.size() ? steps[i] : 0;
  }
  return slices;
}

std::vector<double> repeat(const std::vector<std::pair<int, double>>& blocks) {
  std::vector<double> steps;
  for (const auto& [count, step] : blocks) {
    steps.insert(steps.end(), static_cast<size_t>(count), step);
  }
  return steps;
}

std::string plan_error(const std::vector<std::pair<int, double>>& blocks) {
  return error_of([&] { plan_stack(slices_at(repeat(blocks)), "ct"); });
}

TEST(StackPlan, EvenStackNeedsNothing) {
  const StackPlan plan = plan_stack(slices_at({2, 2.001, 1.999, 2}), "ct");
  EXPECT_FALSE(plan.uneven);
  EXPECT_FALSE(plan.sheared);
  EXPECT_NEAR(plan.step, 2, 1e-9);
}

TEST(StackPlan, TiltIsMeasured) {
  const StackPlan plan =
      plan_stack(slices_at(repeat({{20, 3}}), std::tan(glm::radians(16.5))), "ct");
  EXPECT_TRUE(plan.sheared);
  EXPECT_FALSE(plan.uneven);
  EXPECT_NEAR(plan.tilt_deg, 16.5, 1e-6);
  EXPECT_NEAR(plan.step, 3, 1e-9);
}

TEST(StackPlan, ChangesOfSpacingAreUneven) {
  EXPECT_NEAR(plan_stack(slices_at(repeat({{10, 4}, {10, 7}})), "ct").step, 4, 1e-9);
  EXPECT_NEAR(plan_stack(slices_at(repeat({{10, 2.5}, {10, 5}})), "ct").step, 2.5, 1e-9);
  // A stray overlap between two blocks must not multiply the slices.
  const StackPlan plan = plan_stack(slices_at(repeat({{13, 4}, {1, 1.08}, {13, 7}})), "ct");
  EXPECT_TRUE(plan.uneven);
  EXPECT_NEAR(plan.step, 4, 1e-9);
}

TEST(StackPlan, HolesAreErrorsThatCountThem) {
  EXPECT_THAT(plan_error({{9, 2}, {1, 4}, {9, 2}}), HasSubstr("1 of 21 slices missing"));
  EXPECT_THAT(plan_error({{9, 2}, {1, 4}, {9, 2}}), HasSubstr("after slice 10"));
  EXPECT_THAT(plan_error({{5, 2}, {1, 10}, {5, 2}}), HasSubstr("4 of 16"));
  EXPECT_THAT(plan_error({{4, 3}, {1, 6}, {3, 3}, {1, 9}, {4, 3}}), HasSubstr("3 of 17"));
  EXPECT_THAT(plan_error({{6, 1}, {2, 2}, {6, 1}}), HasSubstr("2 of 17"));  // every second one
  EXPECT_THAT(plan_error({{1, 5}, {1, 10}}), HasSubstr("1 of 4"));
  EXPECT_THAT(plan_error({{10, 2}, {1, 8.7}, {10, 2}}), HasSubstr("missing"));  // and moved
  EXPECT_THAT(plan_error({{8, 4}, {8, 7}, {1, 14}, {8, 7}}), HasSubstr("1 of 27"));
}

TEST(Stacks, LocalizerOfTheSameSeriesStandsApart) {
  std::vector<DicomHeader> headers = slices_at({1, 1, 1});
  DicomHeader localizer = headers[0];
  localizer.row = {0, 1, 0};
  localizer.column = {0, 0, -1};
  headers.insert(headers.begin(), localizer);
  const std::vector<DicomStack> stacks = group_into_stacks(headers);
  ASSERT_EQ(stacks.size(), 2);
  EXPECT_EQ(stacks[0].slices.size(), 4);
}

}  // namespace
}  // namespace clipgs
