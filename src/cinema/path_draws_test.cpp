#include "cinema/path_draws.h"

#include <array>
#include <gtest/gtest.h>
#include <set>
#include <utility>

namespace clipgs {
namespace {

// A (0, 2)-sequence in base 2: of every 16 samples that follow each other, one lies in each box of
// area 1/16, whatever its shape.
TEST(PathDraws, PairsAreEvenInEveryShape) {
  for (std::uint32_t key = 1; key < 50; ++key) {
    for (const auto& [a, b] : {std::pair(path_draws::kPixelX, path_draws::kPixelY),
                               std::pair(path_draws::kAngle, path_draws::kTurn)}) {
      for (std::uint32_t block = 0; block < 4; ++block) {
        for (int columns = 1; columns <= 16; columns *= 2) {
          const int rows = 16 / columns;
          std::set<std::pair<int, int>> boxes;
          for (std::uint32_t i = 16 * block; i < 16 * block + 16; ++i) {
            const float u = path_draws::draw(a, key, i);
            const float v = path_draws::draw(b, key, i);
            ASSERT_TRUE(u >= 0 && u < 1 && v >= 0 && v < 1);
            boxes.emplace(static_cast<int>(u * static_cast<float>(columns)),
                          static_cast<int>(v * static_cast<float>(rows)));
          }
          EXPECT_EQ(boxes.size(), 16) << "key " << key << ", " << columns << " columns";
        }
      }
    }
  }
}

// Different dimensions and keys are unrelated: products of their deviations vanish in the mean.
TEST(PathDraws, DimensionsAndKeysAreIndependent) {
  const auto covariance = [](path_draws::Dimension a, path_draws::Dimension b,
                             std::uint32_t other_key) {
    double sum = 0;
    constexpr std::uint32_t kKeys = 20000;
    for (std::uint32_t key = 0; key < kKeys; ++key) {
      const std::uint32_t index = key % 7;
      sum += (static_cast<double>(path_draws::draw(a, path_draws::hash(key), index)) - 0.5) *
             (static_cast<double>(path_draws::draw(b, path_draws::hash(key + other_key), index)) -
              0.5);
    }
    return sum / kKeys;
  };
  // The standard error of the mean product of two uniform numbers is 1/12/√20000.
  constexpr double kTolerance = 4.0 / 12 / 141;
  EXPECT_NEAR(covariance(path_draws::kDistance, path_draws::kAngle, 0), 0, kTolerance);
  EXPECT_NEAR(covariance(path_draws::kDistance, path_draws::kSurface, 0), 0, kTolerance);
  EXPECT_NEAR(covariance(path_draws::kLensU, path_draws::kDistance2, 0), 0, kTolerance);
  EXPECT_NEAR(covariance(path_draws::kDistance, path_draws::kDistance, 1), 0, kTolerance);
}

}  // namespace
}  // namespace clipgs
