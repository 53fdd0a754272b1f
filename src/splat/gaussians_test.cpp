#include "splat/gaussians.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>

namespace clipgs {
namespace {

Gaussians one_gaussian() {
  Gaussians g(1, 0);
  g.plane(Gaussians::kMean)[0] = 1;
  g.plane(Gaussians::kMean + 1)[0] = -2;
  g.plane(Gaussians::kMean + 2)[0] = 3;
  for (int axis = 0; axis < 3; ++axis) {
    g.plane(Gaussians::kLogScale + axis)[0] = std::log(static_cast<float>(axis + 1));
  }
  // A quarter turn about z, not normalised: local x → world y, local y → −x.
  g.plane(Gaussians::kRotation)[0] = 3;
  g.plane(Gaussians::kRotation + 3)[0] = 3;
  g.plane(Gaussians::kOpacity)[0] = std::log(0.8f / 0.2f);
  return g;
}

TEST(Gaussians, ReadsParameters) {
  const Gaussians g = one_gaussian();
  EXPECT_EQ(g.mean(0), Vec3(1, -2, 3));
  EXPECT_NEAR(g.scale(0).z, 3.0f, 1e-6f);
  EXPECT_NEAR(glm::length(g.rotation(0)), 1.0f, 1e-6f);
  EXPECT_NEAR(g.opacity(0), 0.8f, 1e-6f);
}

TEST(Gaussians, CovarianceOfAQuarterTurnSwapsTheAxes) {
  const Mat3 covariance = one_gaussian().covariance(0);
  const Mat3 expected(4, 0, 0, 0, 1, 0, 0, 0, 9);
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) {
      EXPECT_NEAR(covariance[c][r], expected[c][r], 1e-5f) << c << "," << r;
    }
  }
}

TEST(Gaussians, ZeroQuaternionIsTheIdentity) {
  Gaussians g = one_gaussian();
  g.plane(Gaussians::kRotation)[0] = 0;
  g.plane(Gaussians::kRotation + 3)[0] = 0;
  EXPECT_NEAR(g.covariance(0)[1][1], 4.0f, 1e-5f);
}

TEST(Gaussians, GatherReordersEveryPlane) {
  Gaussians g(3, 1);
  for (int p = 0; p < g.planes(); ++p) {
    for (size_t i = 0; i < 3; ++i) {
      g.plane(p)[i] = static_cast<float>(10 * p) + static_cast<float>(i);
    }
  }
  const Gaussians picked = g.gather({2, 0});
  ASSERT_EQ(picked.size(), 2u);
  ASSERT_EQ(picked.sh_degree(), 1);
  for (int p = 0; p < g.planes(); ++p) {
    EXPECT_EQ(picked.plane(p)[0], g.plane(p)[2]);
    EXPECT_EQ(picked.plane(p)[1], g.plane(p)[0]);
  }
}

TEST(Gaussians, FaceColoursComeAfterTheRest) {
  Gaussians g(2, 1);
  for (size_t k = 0; k < g.data().size(); ++k) {
    g.data()[k] = static_cast<float>(k);
  }
  const Gaussians with = g.reshaped(1, true);
  EXPECT_TRUE(with.has_face_colors());
  EXPECT_FALSE(with.is_like(g));
  ASSERT_EQ(with.planes(), g.planes() + 12);
  ASSERT_EQ(with.face(), g.planes());
  for (int p = 0; p < with.planes(); ++p) {
    EXPECT_EQ(with.plane(p)[1], p < g.planes() ? g.plane(p)[1] : 0);
  }
  const Gaussians more = with.like(5);
  EXPECT_TRUE(more.is_like(with));
  EXPECT_EQ(more.size(), 5u);
  EXPECT_EQ(with.gather({1}).planes(), with.planes());
  EXPECT_EQ(with.reshaped(1, false).data(), g.data());
}

TEST(Gaussians, ReshapingDropsHigherCoefficients) {
  Gaussians g(2, 2, true);
  for (size_t k = 0; k < g.data().size(); ++k) {
    g.data()[k] = static_cast<float>(k);
  }
  const Gaussians lower = g.reshaped(1, true);
  EXPECT_EQ(lower.sh_degree(), 1);
  EXPECT_EQ(lower.plane(Gaussians::kSh + 11)[1], g.plane(Gaussians::kSh + 11)[1]);
  EXPECT_EQ(lower.plane(lower.face())[1], g.plane(g.face())[1]);
  EXPECT_EQ(lower.plane(lower.face() + 11)[0], g.plane(g.face() + 11)[0]);
  const Gaussians higher = lower.reshaped(2, true);
  EXPECT_EQ(higher.plane(Gaussians::kSh + 12)[1], 0);
  EXPECT_EQ(higher.plane(higher.face() + 11)[0], g.plane(g.face() + 11)[0]);
}

// The basis is orthonormal over the sphere: a wrong constant or a missing term shows here.
TEST(ShBasis, IsOrthonormal) {
  constexpr int kCount = sh_coefficients(kMaxShDegree);
  constexpr int kDirections = 20000;
  std::array<std::array<double, kCount>, kCount> gram{};
  for (int i = 0; i < kDirections; ++i) {
    std::array<float, kCount> y{};
    sh_basis(kMaxShDegree, fibonacci_sphere(i, kDirections), y.data());
    for (int a = 0; a < kCount; ++a) {
      for (int b = 0; b < kCount; ++b) {
        gram[a][b] += 4 * 3.14159265358979 / kDirections * y[a] * y[b];
      }
    }
  }
  for (int a = 0; a < kCount; ++a) {
    for (int b = 0; b < kCount; ++b) {
      EXPECT_NEAR(gram[a][b], a == b ? 1.0 : 0.0, 2e-3) << a << "," << b;
    }
  }
}

// Signs and order as in 3DGS: y(−), z(+), x(−) for degree 1, and the poles of the others.
TEST(ShBasis, HasTheSignsOf3dgs) {
  std::array<float, 16> y{};
  sh_basis(3, Vec3(0, 1, 0), y.data());
  EXPECT_LT(y[1], 0);
  EXPECT_GT(y[9], 0);
  EXPECT_LT(y[8], 0);
  sh_basis(3, Vec3(0, 0, 1), y.data());
  EXPECT_GT(y[2], 0);
  EXPECT_GT(y[6], 0);
  EXPECT_GT(y[12], 0);
  sh_basis(3, Vec3(1, 0, 0), y.data());
  EXPECT_LT(y[3], 0);
  EXPECT_GT(y[8], 0);
  EXPECT_GT(y[13], 0);
  EXPECT_LT(y[15], 0);
  const float h = std::sqrt(1.0f / 3.0f);
  sh_basis(3, Vec3(h, h, h), y.data());
  EXPECT_GT(y[4], 0);
  EXPECT_LT(y[5], 0);
  EXPECT_LT(y[7], 0);
  EXPECT_GT(y[10], 0);
  EXPECT_LT(y[11], 0);
  EXPECT_NEAR(y[14], 0, 1e-6f);
  sh_basis(3, glm::normalize(Vec3(1, 0, 1)), y.data());
  EXPECT_GT(y[14], 0);
}

TEST(ShBasis, LowerDegreesWriteOnlyTheirCoefficients) {
  for (int degree = 0; degree <= kMaxShDegree; ++degree) {
    std::array<float, 17> y;
    y.fill(99);
    sh_basis(degree, Vec3(0.6f, 0, 0.8f), y.data());
    EXPECT_NE(y[sh_coefficients(degree) - 1], 99);
    EXPECT_EQ(y[sh_coefficients(degree)], 99);
  }
}

}  // namespace
}  // namespace clipgs
