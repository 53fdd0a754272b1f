#include "volume/volume.h"

#include <algorithm>

namespace clipgs {

float Volume::sample(const VoxelValues& of, const Vec3& world) const {
  const Vec3 index = glm::clamp(index_from_world(world), Vec3(0), Vec3(dims - 1));
  // The last cell serves its far border too, so that x0 + 1 stays inside.
  const IVec3 low = glm::min(IVec3(index), glm::max(dims - 2, IVec3(0)));
  const IVec3 high = glm::min(low + 1, dims - 1);
  const Vec3 t = index - Vec3(low);
  const auto along_x = [&](int y, int z) {
    return glm::mix(of[offset(low.x, y, z)], of[offset(high.x, y, z)], t.x);
  };
  const float near_z = glm::mix(along_x(low.y, low.z), along_x(high.y, low.z), t.y);
  const float far_z = glm::mix(along_x(low.y, high.z), along_x(high.y, high.z), t.y);
  return glm::mix(near_z, far_z, t.z);
}

Box Volume::bounds() const {
  Box box;
  for (int corner = 0; corner < 8; ++corner) {
    const IVec3 pick(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
    box.add(world_from_index(Vec3((dims - 1) * pick)));
  }
  return box;
}

}  // namespace clipgs
