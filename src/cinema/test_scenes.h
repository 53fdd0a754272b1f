#pragma once

#include <cmath>
#include <functional>

#include "volume/preset.h"
#include "volume/volume.h"

// Small scenes with known answers, for the tests of this folder.
namespace clipgs::test {

/// Voxels from a function of the index, 1 mm apart, centred on the world's origin.
inline Volume make_volume(const IVec3& dims, const std::function<float(const IVec3&)>& value) {
  Volume volume;
  volume.dims = dims;
  volume.origin = -0.5f * Vec3(dims - 1);
  std::vector<float> values(volume.voxels());
  for (int z = 0; z < dims.z; ++z) {
    for (int y = 0; y < dims.y; ++y) {
      for (int x = 0; x < dims.x; ++x) {
        values[volume.offset(x, y, z)] = value({x, y, z});
      }
    }
  }
  volume.values = std::move(values);
  return volume;
}

inline TransferPoint point(float value, float extinction, const Vec3& albedo = Vec3(1),
                           float specular = 0, float roughness = 0.4f, float phase = 0) {
  return {value, {albedo, extinction, specular, roughness, phase}};
}

/// Isotropic scattering but for this phase.
inline TransferPoint phase_point(float value, float extinction, float phase) {
  return point(value, extinction, Vec3(1), 0, 0.4f, phase);
}

/// White sky, no keys.
inline LightRig white_sky() { return {Vec3(1), Vec3(1), Vec3(1), {}}; }

/// A white environment again, but of two key lights that each fill half the sphere.
inline LightRig white_keys() {
  const float half_sphere = 1.57079633f;
  return {Vec3(0),
          Vec3(0),
          Vec3(0),
          {{Vec3(0, 0, 1), Vec3(1), half_sphere}, {Vec3(0, 0, -1), Vec3(1), half_sphere}}};
}

/// A dim coloured sky with a bright window in it.
inline Image panorama() {
  Image image(64, 32, 3);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 64; ++x) {
      const bool window = x >= 20 && x < 28 && y >= 6 && y < 14;
      float* pixel = image.at(x, y);
      pixel[0] = window ? 9.0f : 0.1f;
      pixel[1] = window ? 8.0f : 0.01f * static_cast<float>(y);
      pixel[2] = window ? 6.0f : 0.3f;
    }
  }
  return image;
}

inline Preset make_preset(std::vector<TransferPoint> points, LightRig rig,
                          float surface_strength = 0) {
  Preset preset;
  preset.transfer = TransferFunction(std::move(points));
  preset.surface_strength = surface_strength;
  preset.rig = std::move(rig);
  return preset;
}

/// Sample mean and its variance.
class Mean {
 public:
  void add(double x) {
    ++count_;
    const double delta = x - mean_;
    mean_ += delta / count_;
    squares_ += delta * (x - mean_);
  }
  double value() const { return mean_; }
  double variance() const { return squares_ / (count_ - 1) / count_; }
  /// Four standard errors: passes 15,999 times of 16,000 if the expectation is right.
  double tolerance() const { return 4 * std::sqrt(variance()); }

 private:
  double count_ = 0;
  double mean_ = 0;
  double squares_ = 0;
};

}  // namespace clipgs::test
