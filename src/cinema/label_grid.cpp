#include "cinema/label_grid.h"

namespace clipgs {

LabelGrid::LabelGrid(const Volume& volume, const LabelLooks& looks)
    : stride_y_(VoxelGrid::padded(volume.dims).x),
      stride_z_(stride_y_ * VoxelGrid::padded(volume.dims).y),
      middle_(VoxelGrid::middle(volume.dims)) {
  const std::vector<LabelLook> of_index = looks_of_labels(volume, looks);
  for (size_t i = 0; i < of_index.size(); ++i) {
    looks_.opacity[i] = of_index[i].opacity;
    looks_.has_albedo[i] = of_index[i].albedo ? 1.0f : 0.0f;
    for (int c = 0; c < 3; ++c) {
      looks_.albedo[static_cast<size_t>(c)][i] = of_index[i].albedo.value_or(Vec3(0))[c];
    }
  }
  constexpr size_t kOverread = 3;
  const IVec3 padded = VoxelGrid::padded(volume.dims);
  indices_.resize(static_cast<size_t>(stride_z_) * static_cast<size_t>(padded.z) + kOverread);
  VoxelGrid::for_each_padded(volume,
                             [&](size_t to, size_t from) { indices_[to] = volume.labels[from]; });
}

float LabelGrid::mean_opacity(const Vec3& voxel) const {
  const Vec3 low = glm::floor(voxel);
  const Vec3 f = voxel - low;
  const IVec3 at(low);
  const auto along_x = [&](int y, int z) {
    return glm::mix(opacity(at.x, y, z), opacity(at.x + 1, y, z), f.x);
  };
  const float near = glm::mix(along_x(at.y, at.z), along_x(at.y + 1, at.z), f.y);
  const float far = glm::mix(along_x(at.y, at.z + 1), along_x(at.y + 1, at.z + 1), f.y);
  return glm::mix(near, far, f.z);
}

}  // namespace clipgs
