#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/body_part.h"
#include "core/defaced.h"
#include "core/geometry.h"
#include "core/modality.h"
#include "volume/hints.h"
#include "volume/voxel_values.h"

namespace clipgs {

/// Side of a cube as large as a voxel, mm: the length of "a voxel" where no axis is meant, so that
/// the same matter looks the same on cubes and on thick slices.
inline float mean_spacing(const Vec3& spacing) {
  return std::cbrt(spacing.x * spacing.y * spacing.z);
}

/// A regular grid of voxels, x fastest. The first index axis runs roughly to the patient's Right,
/// the second Anterior, the third Superior (loading flips and permutes axes so).
///
///   values  [nz, ny, nx]        HU for CT, stored units otherwise (luminance 0…255 of
///   photographs);
///                               floats that are kept in 16 bits where they are few enough
///   scanned [nz, ny, nx]        values as they were read, where noise or streaks were taken out of
///                               `values` for the pictures' sake (prepare()); empty otherwise
///   rgb     [nz, ny, nx, 3] u8  sRGB, only for photographs; empty otherwise
///   labels  [nz, ny, nx] u8     index into label_numbers; empty without a segmentation
struct Volume {
  IVec3 dims{0};        ///< voxels along the three index axes
  Vec3 spacing{1};      ///< mm between voxel centres
  Mat3 direction{1};    ///< columns: unit RAS directions of the index axes (a rotation)
  Vec3 origin{0};       ///< RAS mm of the centre of voxel (0, 0, 0)
  IVec3 upsampling{1};  ///< voxels in place of one that was scanned, along each axis (upsample())
  Modality modality = Modality::kUnknown;
  BodyPart part = BodyPart::kUnknown;  ///< as somebody says, or a CT's voxels tell
  VoxelValues values;
  VoxelValues scanned;
  std::vector<std::uint8_t> rgb;
  std::vector<std::uint8_t> labels;
  std::vector<int> label_numbers;  ///< as the segmentation's file has them; the first is 0
  Hints hints;                     ///< what the file's header says, beside the modality
  std::optional<Defaced> defaced;  ///< what went with its face (deface()); none: nothing

  size_t voxels() const { return static_cast<size_t>(dims.x) * dims.y * dims.z; }
  size_t offset(int x, int y, int z) const {
    return (static_cast<size_t>(z) * dims.y + y) * dims.x + x;
  }
  /// mm between the centres of voxels that were scanned: how fine the volume tells things apart.
  Vec3 scanned_spacing() const { return spacing * Vec3(upsampling); }
  float at(int x, int y, int z) const { return values[offset(x, y, z)]; }

  /// What a person reads as the value of a voxel.
  const VoxelValues& readings() const { return scanned.empty() ? values : scanned; }

  /// World (RAS mm) ↔ continuous voxel index; integer indices are voxel centres.
  Vec3 world_from_index(const Vec3& index) const { return origin + direction * (index * spacing); }
  Vec3 index_from_world(const Vec3& world) const {
    return ((world - origin) * direction) / spacing;  // v * M is transpose(M) * v
  }

  /// Trilinear value at a world position; positions outside the grid take the nearest voxel's.
  float sample(const Vec3& world) const { return sample(values, world); }
  /// The same of other values of its voxels.
  float sample(const VoxelValues& of, const Vec3& world) const;
  /// World-space box around all voxel centres.
  Box bounds() const;
};

}  // namespace clipgs
