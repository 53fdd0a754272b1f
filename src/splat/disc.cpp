#include "splat/disc.h"

#include <array>
#include <cmath>

namespace clipgs {

namespace {

Quat facing(const Vec3& normal) {
  Vec3 u;
  Vec3 v;
  orthonormal_basis(normal, u, v);
  return glm::quat_cast(Mat3(u, v, normal));
}

}  // namespace

void place(const Disc& disc, size_t i, Gaussians& gaussians) {
  const Quat rotation = facing(disc.normal);
  const std::array<float, 4> wxyz = {rotation.w, rotation.x, rotation.y, rotation.z};
  for (int a = 0; a < 3; ++a) {
    gaussians.plane(Gaussians::kMean + a)[i] = disc.position[a];
    gaussians.plane(Gaussians::kLogScale + a)[i] = std::log(a == 2 ? disc.thick : disc.wide);
    gaussians.plane(Gaussians::kSh + a)[i] = (disc.color[a] - 0.5f) / kShBand0;
  }
  for (int k = 0; k < 4; ++k) {
    gaussians.plane(Gaussians::kRotation + k)[i] = wxyz[static_cast<size_t>(k)];
  }
  gaussians.plane(Gaussians::kOpacity)[i] = std::log(disc.opacity / (1 - disc.opacity));
}

}  // namespace clipgs
