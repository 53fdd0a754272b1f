#include "splat/face_gain.h"

#include "splat/gaussians.h"

namespace clipgs {

Vec3 FaceGain::at(const Vec3& normal) const {
  std::array<float, kCoefficients> basis;
  sh_basis(kDegree, normal, basis.data());
  Vec3 exponent(0);
  for (size_t k = 0; k < kCoefficients; ++k) {
    exponent += basis[k] * coefficients[k];
  }
  return glm::exp(exponent);
}

}  // namespace clipgs
