#include "volume/phantom.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/parallel.h"
#include "volume/phantom_body.h"

namespace clipgs {
namespace {

Volume air(const IVec3& dims, float spacing) {
  Volume volume;
  volume.dims = dims;
  volume.spacing = Vec3(spacing);
  volume.origin = -0.5f * Vec3(dims - 1) * spacing;
  volume.modality = Modality::kCt;
  volume.values = std::vector<float>(volume.voxels(), -1000.0f);
  return volume;
}

/// The kernel of a scanner's blur, in voxels: a Gaussian of about 1.6 voxels' full width at half
/// maximum, normalised.
std::array<float, 5> scanner_blur() {
  constexpr float kDeviation = 0.7f;
  std::array<float, 5> kernel{};
  float sum = 0;
  for (int k = 0; k < 5; ++k) {
    const auto offset = static_cast<float>(k - 2);
    kernel[k] = std::exp(-0.5f * offset * offset / (kDeviation * kDeviation));
    sum += kernel[k];
  }
  for (float& weight : kernel) {
    weight /= sum;
  }
  return kernel;
}

/// Blurs along one axis; the volume's edge goes on beyond it.
void blur_along(Volume& volume, int axis, const std::array<float, 5>& kernel) {
  const IVec3 dims = volume.dims;
  std::vector<float>& values = volume.values.unpack();
  const std::vector<float> sharp = values;
  parallel_for(static_cast<size_t>(dims.z), 1, [&](size_t begin, size_t end) {
    for (int z = static_cast<int>(begin); z < static_cast<int>(end); ++z) {
      for (int y = 0; y < dims.y; ++y) {
        for (int x = 0; x < dims.x; ++x) {
          float sum = 0;
          for (int k = 0; k < 5; ++k) {
            IVec3 p(x, y, z);
            p[axis] = std::clamp(p[axis] + k - 2, 0, dims[axis] - 1);
            sum += kernel[k] * sharp[volume.offset(p.x, p.y, p.z)];
          }
          values[volume.offset(x, y, z)] = sum;
        }
      }
    }
  });
}

}  // namespace

Volume make_phantom(int size, std::uint64_t seed) {
  if (size < 16 || size > 1024) {
    throw Error("phantom: size {} must lie in 16..1024", size);
  }
  const Vec3 extent(348, 240, 400);  // mm
  const float spacing = extent.z / static_cast<float>(size);
  Volume volume = air(IVec3(glm::round(extent / spacing)), spacing);

  phantom::Painter painter(volume, seed);
  phantom::paint_wall(painter);
  phantom::paint_organs(painter);
  phantom::paint_chest(painter, seed);
  phantom::paint_vessels(painter, seed);
  phantom::paint_skeleton(painter);

  // No scanner sees edges as sharp as they were painted, and shaded surfaces would show the voxels.
  const std::array<float, 5> kernel = scanner_blur();
  for (int axis = 0; axis < 3; ++axis) {
    blur_along(volume, axis, kernel);
  }
  // Whole HU, as scanners store them: files stay small and give back the same values.
  volume.values.transform([](float value) { return std::round(value); });
  volume.values.pack();
  return volume;
}

Volume make_ball(int size, float radius_mm, float inside, float outside) {
  if (size < 2) {
    throw Error("ball: size {} must be at least 2", size);
  }
  Volume volume = air(IVec3(size), 1);
  std::vector<float>& values = volume.values.unpack();
  for (int z = 0; z < size; ++z) {
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const float d = glm::length(volume.world_from_index(Vec3(x, y, z))) - radius_mm;
        values[volume.offset(x, y, z)] =
            glm::mix(outside, inside, std::clamp(0.5f - d, 0.0f, 1.0f));
      }
    }
  }
  return volume;
}

}  // namespace clipgs
