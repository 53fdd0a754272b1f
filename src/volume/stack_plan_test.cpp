#include "volume/stack_plan.h"

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
  return error_of([&] { plan_stack(slices_at(repeat(blocks)), Gaps::kRefuse, "ct"); });
}

TEST(StackPlan, EvenStackNeedsNothing) {
  const StackPlan plan = plan_stack(slices_at({2, 2.001, 1.999, 2}), Gaps::kRefuse, "ct");
  EXPECT_FALSE(plan.uneven);
  EXPECT_FALSE(plan.sheared);
  EXPECT_NEAR(plan.step, 2, 1e-9);
}

TEST(StackPlan, TiltIsMeasured) {
  const StackPlan plan =
      plan_stack(slices_at(repeat({{20, 3}}), std::tan(glm::radians(16.5))), Gaps::kRefuse, "ct");
  EXPECT_TRUE(plan.sheared);
  EXPECT_FALSE(plan.uneven);
  EXPECT_NEAR(plan.tilt_deg, 16.5, 1e-6);
  EXPECT_NEAR(plan.step, 3, 1e-9);
}

TEST(StackPlan, ChangesOfSpacingAreUneven) {
  EXPECT_NEAR(plan_stack(slices_at(repeat({{10, 4}, {10, 7}})), Gaps::kRefuse, "ct").step, 4, 1e-9);
  EXPECT_NEAR(plan_stack(slices_at(repeat({{10, 2.5}, {10, 5}})), Gaps::kRefuse, "ct").step, 2.5,
              1e-9);
  // A stray overlap between two blocks must not multiply the slices.
  const StackPlan plan =
      plan_stack(slices_at(repeat({{13, 4}, {1, 1.08}, {13, 7}})), Gaps::kRefuse, "ct");
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

std::string described(const std::vector<std::pair<int, double>>& blocks) {
  const std::vector<DicomHeader> slices = slices_at(repeat(blocks));
  return describe_gaps(plan_stack(slices, Gaps::kInterpolate, "ct"), slices);
}

TEST(StackPlan, AFewMissingSlicesArePlanned) {
  const std::vector<DicomHeader> slices = slices_at(repeat({{9, 2.001}, {1, 4}, {9, 1.999}}));
  const StackPlan plan = plan_stack(slices, Gaps::kInterpolate, "ct");
  EXPECT_FALSE(plan.uneven);
  EXPECT_TRUE(plan.resampled());
  ASSERT_EQ(plan.gaps.size(), 1);
  EXPECT_EQ(plan.gaps[0].after, 9);
  EXPECT_EQ(plan.gaps[0].missing, 1);
  EXPECT_NEAR(plan.step, 2, 1e-9);
  EXPECT_EQ(described({{9, 2}, {1, 4}, {9, 2}}),
            "1 of 21 slices is missing: slice 11 (at 25.00 mm)");
  EXPECT_EQ(
      described({{20, 2}, {1, 8}, {10, 2}, {1, 4}, {20, 2}}),
      "4 of 57 slices are missing: slices 22 to 24 (at 47.00 to 51.00 mm), slice 36 (at 75.00 "
      "mm)");
  // Beside a change of spacing, which stays one.
  EXPECT_EQ(described({{20, 4}, {20, 7}, {1, 14}, {8, 7}}),
            "1 of 51 slices is missing: slice 42 (at 232.00 mm)");
}

TEST(StackPlan, MoreThanAFewAreRefusedAllTheSame) {
  const auto error = [](const std::vector<std::pair<int, double>>& blocks) {
    return error_of([&] { plan_stack(slices_at(repeat(blocks)), Gaps::kInterpolate, "ct"); });
  };
  EXPECT_EQ(error({{40, 2}, {1, 8}, {40, 2}}), "");
  EXPECT_THAT(error({{40, 2}, {1, 10}, {40, 2}}), HasSubstr("4 of 86"));               // in a row
  EXPECT_THAT(error({{5, 2}, {1, 4}, {4, 2}, {1, 4}, {5, 2}}), HasSubstr("2 of 19"));  // a tenth
  EXPECT_THAT(error({{3, 2}, {1, 4}, {3, 2}}), HasSubstr("1 of 9"));
  EXPECT_THAT(error({{9, 2}, {1, 4e9}, {9, 2}}), HasSubstr("missing"));
}

}  // namespace
}  // namespace clipgs
