#include "splat/trim.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "splat/select.h"

namespace clipgs {

namespace {

constexpr float kReach = 3;  // standard deviations
constexpr int kMostPasses = 4;
constexpr double kThinnest = 1e-4;  // mm: none is pressed to nothing

/// Sets rotation and log scales to those of a covariance (mm²).
void set_shape(Gaussians& gaussians, size_t i, const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0) {
    axes.col(0) *= -1;
  }
  const Eigen::Quaterniond q(axes);
  const std::array wxyz = {q.w(), q.x(), q.y(), q.z()};
  for (int k = 0; k < 4; ++k) {
    gaussians.plane(Gaussians::kRotation + k)[i] = static_cast<float>(wxyz[static_cast<size_t>(k)]);
  }
  for (int a = 0; a < 3; ++a) {
    const double deviation = std::sqrt(std::max(solver.eigenvalues()[a], kThinnest * kThinnest));
    gaussians.plane(Gaussians::kLogScale + a)[i] = static_cast<float>(std::log(deviation));
  }
}

/// Presses Gaussian `i`, whose middle is `inside` mm behind the plane, until it ends there.
void press(Gaussians& gaussians, size_t i, const Vec3& normal, float inside) {
  const Mat3 covariance = gaussians.covariance(i);
  const float deviation = std::sqrt(glm::dot(normal, covariance * normal));
  if (kReach * deviation <= inside) {
    return;
  }
  const double kept = std::max(inside / (kReach * deviation), 1e-3f);
  Eigen::Matrix3d sigma;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      sigma(row, column) = covariance[column][row];
    }
  }
  const Eigen::Vector3d n(normal.x, normal.y, normal.z);
  const Eigen::Matrix3d flat = Eigen::Matrix3d::Identity() - (1 - kept) * n * n.transpose();
  set_shape(gaussians, i, flat * sigma * flat.transpose());
}

}  // namespace

Gaussians trim(const Gaussians& gaussians, std::span<const Plane> planes) {
  Gaussians trimmed = select(gaussians, [&](size_t i) {
    const Vec3 mean = gaussians.mean(i);
    return std::ranges::all_of(planes,
                               [&](const Plane& plane) { return plane.signed_distance(mean) > 0; });
  });
  // What is pressed by one plane may bulge towards another.
  for (int pass = 0; pass < static_cast<int>(planes.size()) && pass < kMostPasses; ++pass) {
    for (const Plane& plane : planes) {
      for (size_t i = 0; i < trimmed.size(); ++i) {
        press(trimmed, i, plane.normal, plane.signed_distance(trimmed.mean(i)));
      }
    }
  }
  return trimmed;
}

}  // namespace clipgs
