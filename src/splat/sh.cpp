#include "splat/sh.h"

#include <cmath>

namespace clipgs {

namespace {

constexpr float kY1 = 0.48860251f;
constexpr float kY2[5] = {1.0925484f, -1.0925484f, 0.31539157f, -1.0925484f, 0.54627422f};
constexpr float kY3[7] = {-0.59004359f, 2.8906114f, -0.45704580f, 0.37317633f,
                          -0.45704580f, 1.4453057f, -0.59004359f};

/// ∂Yₖ/∂direction, Y as polynomials in x, y, z (the unit constraint is applied by the caller).
void sh_basis_gradient(int degree, const Vec3& d, Vec3* g) {
  const float x = d.x, y = d.y, z = d.z;
  g[0] = Vec3(0);
  if (degree >= 1) {
    g[1] = Vec3(0, -kY1, 0);
    g[2] = Vec3(0, 0, kY1);
    g[3] = Vec3(-kY1, 0, 0);
  }
  if (degree >= 2) {
    g[4] = kY2[0] * Vec3(y, x, 0);
    g[5] = kY2[1] * Vec3(0, z, y);
    g[6] = kY2[2] * Vec3(-2 * x, -2 * y, 4 * z);
    g[7] = kY2[3] * Vec3(z, 0, x);
    g[8] = kY2[4] * Vec3(2 * x, -2 * y, 0);
  }
  if (degree >= 3) {
    const float xx = x * x, yy = y * y, zz = z * z;
    g[9] = kY3[0] * Vec3(6 * x * y, 3 * xx - 3 * yy, 0);
    g[10] = kY3[1] * Vec3(y * z, x * z, x * y);
    g[11] = kY3[2] * Vec3(-2 * x * y, 4 * zz - xx - 3 * yy, 8 * y * z);
    g[12] = kY3[3] * Vec3(-6 * x * z, -6 * y * z, 6 * zz - 3 * xx - 3 * yy);
    g[13] = kY3[4] * Vec3(4 * zz - 3 * xx - yy, -2 * x * y, 8 * x * z);
    g[14] = kY3[5] * Vec3(2 * x * z, -2 * y * z, xx - yy);
    g[15] = kY3[6] * Vec3(3 * xx - 3 * yy, -6 * x * y, 0);
  }
}

}  // namespace

Vec3 sh_color(const Gaussians& gaussians, size_t i, const Vec3& direction) {
  float basis[sh_coefficients(kMaxShDegree)];
  sh_basis(gaussians.sh_degree(), direction, basis);
  Vec3 color(0.5f);
  for (int k = 0; k < sh_coefficients(gaussians.sh_degree()); ++k) {
    for (int c = 0; c < 3; ++c) {
      color[c] += basis[k] * gaussians.plane(Gaussians::kSh + 3 * k + c)[i];
    }
  }
  return color;
}

Vec3 sh_color_backward(const Gaussians& gaussians, size_t i, const Vec3& offset,
                       const Vec3& color_gradient, Gaussians& gradients) {
  const int degree = gaussians.sh_degree();
  const float distance = glm::length(offset);
  const Vec3 direction = offset / distance;
  float basis[sh_coefficients(kMaxShDegree)];
  Vec3 basis_gradient[sh_coefficients(kMaxShDegree)];
  sh_basis(degree, direction, basis);
  sh_basis_gradient(degree, direction, basis_gradient);
  Vec3 g_direction(0);
  for (int k = 0; k < sh_coefficients(degree); ++k) {
    float along = 0;
    for (int c = 0; c < 3; ++c) {
      gradients.plane(Gaussians::kSh + 3 * k + c)[i] = basis[k] * color_gradient[c];
      along += gaussians.plane(Gaussians::kSh + 3 * k + c)[i] * color_gradient[c];
    }
    g_direction += along * basis_gradient[k];
  }
  return (g_direction - glm::dot(g_direction, direction) * direction) / distance;
}

Vec3 face_color(const Gaussians& gaussians, size_t i, const Vec3& normal) {
  float basis[sh_coefficients(Gaussians::kFaceDegree)];
  sh_basis(Gaussians::kFaceDegree, normal, basis);
  Vec3 color(0);
  for (int p = 0; p < Gaussians::kFacePlanes; ++p) {
    color[p % 3] += basis[p / 3] * gaussians.plane(gaussians.face() + p)[i];
  }
  return color;
}

void face_color_backward(size_t i, const Vec3& normal, const Vec3& color_gradient,
                         Gaussians& gradients) {
  float basis[sh_coefficients(Gaussians::kFaceDegree)];
  sh_basis(Gaussians::kFaceDegree, normal, basis);
  for (int p = 0; p < Gaussians::kFacePlanes; ++p) {
    gradients.plane(gradients.face() + p)[i] = basis[p / 3] * color_gradient[p % 3];
  }
}

}  // namespace clipgs
