#include "splat/gaussians.h"

#include <algorithm>
#include <cmath>

namespace clipgs {

Vec3 Gaussians::scale(size_t i) const {
  return {std::exp(plane(kLogScale)[i]), std::exp(plane(kLogScale + 1)[i]),
          std::exp(plane(kLogScale + 2)[i])};
}

Quat Gaussians::rotation(size_t i) const {
  const Quat q(plane(kRotation)[i], plane(kRotation + 1)[i], plane(kRotation + 2)[i],
               plane(kRotation + 3)[i]);
  return glm::normalize(q);  // GLM returns the identity for a zero quaternion
}

Mat3 Gaussians::covariance(size_t i) const {
  Mat3 axes = glm::mat3_cast(rotation(i));
  const Vec3 s = scale(i);
  axes[0] *= s.x;
  axes[1] *= s.y;
  axes[2] *= s.z;
  return axes * glm::transpose(axes);
}

float Gaussians::opacity(size_t i) const { return 1.0f / (1.0f + std::exp(-plane(kOpacity)[i])); }

Gaussians Gaussians::gather(const std::vector<size_t>& order) const {
  Gaussians result = like(order.size());
  for (int p = 0; p < planes(); ++p) {
    const float* from = plane(p);
    float* to = result.plane(p);
    for (size_t i = 0; i < order.size(); ++i) {
      to[i] = from[order[i]];
    }
  }
  return result;
}

Gaussians Gaussians::reshaped(int sh_degree, bool face_colors) const {
  Gaussians result(size_, sh_degree, face_colors);
  std::copy_n(data_.begin(), size_ * static_cast<size_t>(std::min(face(), result.face())),
              result.data_.begin());
  if (face_colors_ && face_colors) {
    std::copy_n(plane(face()), size_ * kFacePlanes, result.plane(result.face()));
  }
  return result;
}

void sh_basis(int degree, const Vec3& direction, float* values) {
  values[0] = kShBand0;
  if (degree < 1) {
    return;
  }
  const float x = direction.x;
  const float y = direction.y;
  const float z = direction.z;
  constexpr float kC1 = 0.4886025119029199f;
  values[1] = -kC1 * y;
  values[2] = kC1 * z;
  values[3] = -kC1 * x;
  if (degree < 2) {
    return;
  }
  const float xx = x * x;
  const float yy = y * y;
  const float zz = z * z;
  values[4] = 1.0925484305920792f * x * y;
  values[5] = -1.0925484305920792f * y * z;
  values[6] = 0.31539156525252005f * (2 * zz - xx - yy);
  values[7] = -1.0925484305920792f * x * z;
  values[8] = 0.5462742152960396f * (xx - yy);
  if (degree < 3) {
    return;
  }
  values[9] = -0.5900435899266435f * y * (3 * xx - yy);
  values[10] = 2.890611442640554f * x * y * z;
  values[11] = -0.4570457994644658f * y * (4 * zz - xx - yy);
  values[12] = 0.3731763325901154f * z * (2 * zz - 3 * xx - 3 * yy);
  values[13] = -0.4570457994644658f * x * (4 * zz - xx - yy);
  values[14] = 1.445305721320277f * z * (xx - yy);
  values[15] = -0.5900435899266435f * x * (xx - 3 * yy);
}

}  // namespace clipgs
