#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/geometry.h"
#include "section/value_curve.h"
#include "volume/preset.h"
#include "volume/volume.h"

namespace clipgs {

/// What an exposed face shows of matter with one code.
struct FaceMaterial {
  float extinction = 0;  ///< σ_t, 1/mm
  float specular = 0;    ///< weight of the gloss, 0…1
  float roughness = 0.5f;
  Vec3 surface{0};   ///< reflectance of matter at the face, linear RGB, gloss not counted
  Vec3 interior{0};  ///< … of matter seen through the face, beyond `Section::surface_depth`
};

/// The compact volume that exposed faces are drawn from, and how they are lit (method.md §8).
///
///   voxels  [nz, ny, nx] u8     codes of `curve`, or
///           [nz, ny, nx, 3] u8  sRGB for photographs, whose code is their luminance
///
/// The first voxel's centre is a corner of the box that is drawn, the last one's the opposite.
/// Air around the body has code 0 and everything else codes from kFirstInside, so that neither
/// interpolation nor lossy coding makes the one look like the other.
struct Section {
  static constexpr int kFirstInside = 16;
  static constexpr size_t kErrorBands = 16;

  IVec3 dims{0};
  Vec3 spacing{1};    ///< mm between voxel centres
  Mat3 direction{1};  ///< columns: unit RAS directions of the index axes (a rotation)
  Vec3 origin{0};     ///< RAS mm of the centre of voxel (0, 0, 0)
  int channels = 1;   ///< 1 or 3
  std::vector<std::uint8_t> voxels;

  Modality modality = Modality::kUnknown;
  ValueCurve curve;  ///< code → HU for CT, stored units otherwise
  /// Rms of |value read back − volume's value| for codes 16k … 16k + 15, value units.
  std::array<float, kErrorBands> value_errors{};
  Vec3 source_spacing{1};  ///< mm, of the volume that was traced

  std::array<FaceMaterial, ValueCurve::kCodes> materials{};
  LightRig rig;
  float exposure = 1;

  size_t voxel_count() const { return static_cast<size_t>(dims.x) * dims.y * dims.z; }
  size_t offset(int x, int y, int z) const {
    return (static_cast<size_t>(z) * dims.y + y) * dims.x + x;
  }
  Vec3 index_from_world(const Vec3& world) const {
    return ((world - origin) * direction) / spacing;
  }
  Vec3 world_from_index(const Vec3& index) const { return origin + direction * (index * spacing); }
  /// Trilinear voxel, each channel in 0…255, at an index in [0, dims − 1]; beyond, the nearest.
  Vec3 sample(const Vec3& index) const {
    const Vec3 at = glm::clamp(index, Vec3(0), Vec3(dims - 1));
    const IVec3 low = glm::min(IVec3(at), glm::max(dims - 2, IVec3(0)));
    const IVec3 step = glm::min(IVec3(1), dims - 1 - low);
    const Vec3 t = at - Vec3(low);
    const size_t x = static_cast<size_t>(step.x) * channels;
    const size_t y = static_cast<size_t>(step.y) * dims.x * channels;
    const size_t z = static_cast<size_t>(step.z) * dims.x * dims.y * channels;
    const std::uint8_t* v = &voxels[offset(low.x, low.y, low.z) * channels];
    const auto channel = [&](const std::uint8_t* c) {
      const float near =
          glm::mix(glm::mix<float>(c[0], c[x], t.x), glm::mix<float>(c[y], c[y + x], t.x), t.y);
      const float far = glm::mix(glm::mix<float>(c[z], c[z + x], t.x),
                                 glm::mix<float>(c[z + y], c[z + y + x], t.x), t.y);
      return glm::mix(near, far, t.z);
    };
    return channels == 1 ? Vec3(channel(v), 0, 0)
                         : Vec3(channel(v), channel(v + 1), channel(v + 2));
  }
  /// Code of what `sample` returned: photographs are loaded with Rec. 709 luma as their values.
  float code(const Vec3& sampled) const {
    return channels == 1 ? sampled.x : glm::dot(sampled, Vec3(0.2126f, 0.7152f, 0.0722f));
  }
  /// A value, and its rms error.
  struct Reading {
    float value = 0;
    float error = 0;
  };
  /// What is at a point (RAS mm); nothing outside the box and in the air around the body.
  std::optional<Reading> read(const Vec3& world) const;
  /// Index into `value_errors`.
  static size_t error_band(float code) {
    return std::min(static_cast<size_t>(code) * kErrorBands / ValueCurve::kCodes, kErrorBands - 1);
  }
  /// The sides of the box at which matter ends only because the volume does, as planes that keep
  /// the inside: they are faces as those of a cut are.
  std::vector<Plane> ends() const;
  /// Half a voxel of the traced volume along unit `normal` (RAS), mm: matter less deep than this is
  /// lit as the face itself.
  float surface_depth(const Vec3& normal) const;
};

/// Linear albedo of a photograph's colour as Section::sample() returns it.
Vec3 photo_albedo(const Vec3& sampled);

struct SectionOptions {
  int size = 384;  ///< voxels along each side, at most; never finer than the volume
};

/// The part of `volume` that `preset` shows, resampled; air around the body is left out.
/// Reflectances start as the preset's albedo; fit_reflectance() makes them right. Throws Error if
/// nothing is visible or the size is out of range.
Section make_section(const Volume& volume, const Preset& preset, const SectionOptions& options);

/// The same section with at most `size` voxels along each side; as it is if it has no more.
/// Its value_errors grow by what the voxels that are left do not tell. Throws Error if the size is
/// out of range.
Section resize_section(const Section& section, int size);

}  // namespace clipgs
