#pragma once

#include <array>
#include <memory>
#include <vector>

#include "cinema/label_grid.h"
#include "cinema/lights.h"
#include "cinema/majorant_grid.h"
#include "cinema/voxel_grid.h"
#include "volume/preset.h"
#include "volume/volume.h"
#include "volume/volume_size.h"

namespace clipgs {

/// The transfer function's materials, one array a quantity, for many look-ups at once.
struct MaterialTables {
  using Table = std::array<float, TransferFunction::kTableSize>;
  Table extinction;
  std::array<Table, 3> albedo;
  Table specular, roughness, phase;
};

/// Bytes of memory that a CinemaScene of such a volume takes beside it, and pictures of it.
std::uint64_t tracing_memory(const VolumeSize& size);

/// Bytes of memory that pictures of such a volume take beside it: those of its finer voxels
/// (volume/upsample.h), or of it as it is.
std::uint64_t picture_memory(const VolumeSize& size, bool upsample);

/// A volume made ready for path tracing under a preset, with its labels if it has any. Tracing
/// works in *voxel space* (continuous voxel index) for positions and in the *grid frame* (the
/// volume's axes, unit length = mm) for directions, normals and lights.
///
/// The volume must outlive the scene.
class CinemaScene {
 public:
  CinemaScene(const Volume& volume, const Preset& preset);

  Vec3 voxel_from_world(const Vec3& world) const { return volume_->index_from_world(world); }
  Vec3 frame_from_world(const Vec3& direction) const { return direction * volume_->direction; }
  /// Voxels per mm along a direction of the grid frame.
  Vec3 voxel_direction(const Vec3& direction) const { return direction * inverse_spacing_; }

  const Vec3& inverse_spacing() const { return inverse_spacing_; }
  /// How far above a surface light leaves it, a mean voxel of the scan, in voxel space: a factor of
  /// the unit normal in the grid frame.
  const Vec3& lift() const { return lift_; }

  /// Mean extinction at a voxel position, 1/mm: that of the value, thinned by labels and where the
  /// values are even.
  float extinction(const Vec3& voxel) const;
  const MaterialTables& materials() const { return *tables_; }
  /// What they are where values are steepest; null for presets without a boundary's look.
  const MaterialTables* boundary_materials() const { return boundary_tables_.get(); }
  /// Entry of the tables at an interpolated code: its integer part after scale and offset, clamped.
  float entry_scale() const { return entry_scale_; }
  float entry_offset() const { return entry_offset_; }

  /// Photographs have colours of their own, which the materials' albedos are multiplied by.
  bool has_photo() const { return !photo_.empty(); }
  /// Trilinear between the colours of matter (matter_colors.h), linear RGB.
  Vec3 photo(const Vec3& voxel) const;
  /// Null for a volume without labels.
  const LabelGrid* labels() const { return labels_.get(); }
  /// Value units per mm, for differences of codes over a voxel.
  const Vec3& gradient_scale() const { return gradient_scale_; }

  const Volume& volume() const { return *volume_; }
  const Preset& preset() const { return preset_; }
  const VoxelGrid& grid() const { return grid_; }
  const MajorantGrid& majorants() const { return majorants_; }
  const Lights& lights() const { return lights_; }

 private:
  int entry(float code) const {
    const float t = code * entry_scale_ + entry_offset_;
    return t < 0                               ? 0
           : t >= TransferFunction::kTableSize ? TransferFunction::kTableSize - 1
                                               : static_cast<int>(t);
  }

  const Volume* volume_;
  Preset preset_;
  VoxelGrid grid_;
  std::unique_ptr<LabelGrid> labels_;
  MajorantGrid majorants_;
  Lights lights_;
  Vec3 inverse_spacing_;
  Vec3 lift_;
  Vec3 gradient_scale_;
  float entry_scale_ = 0;
  float entry_offset_ = 0;
  std::unique_ptr<MaterialTables> tables_;
  std::unique_ptr<MaterialTables> boundary_tables_;
  std::vector<std::uint8_t> photo_;  // [nz, ny, nx, 3] sRGB; empty without colours
};

}  // namespace clipgs
