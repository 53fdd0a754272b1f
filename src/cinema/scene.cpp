#include "cinema/scene.h"

#include <algorithm>
#include <array>

#include "cinema/matter_colors.h"
#include "core/image.h"
#include "volume/upsample.h"

namespace clipgs {
namespace {

// The interval of values that 16-bit codes cover: the volume's own, but not further beyond the
// transfer function's than twice its width, so that a few extreme values (metal, padding) do not
// coarsen all others. Values beyond only shape the interpolation towards such voxels, and
// gradients: one that is cut off there still is as steep as gradient opacity and the boundary's
// look ask for.
Vec2 coded_interval(const Volume& volume, const Preset& preset) {
  const TransferFunction& transfer = preset.transfer;
  const auto [lowest, highest] = volume.values.range();
  const float steepest = std::max(preset.gradient_opacity ? preset.gradient_opacity->to : 0.0f,
                                  preset.boundary ? preset.boundary->range.to : 0.0f);
  const Vec3& s = volume.spacing;
  const float margin = std::max({2.0f * (transfer.max_value() - transfer.min_value()), 1.0f,
                                 2.0f * steepest * std::max({s.x, s.y, s.z})});
  return {std::max(lowest, transfer.min_value() - margin),
          std::min(highest, transfer.max_value() + margin)};
}

VoxelGrid make_grid(const Volume& volume, const Preset& preset) {
  const Vec2 interval = coded_interval(volume, preset);
  return {volume, interval.x, interval.y};
}

/// `material_of(value)` at every entry.
template <typename Materials>
std::unique_ptr<MaterialTables> make_tables(const TransferFunction& transfer,
                                            const Materials& material_of) {
  auto tables = std::make_unique<MaterialTables>();
  const float range = transfer.max_value() - transfer.min_value();
  for (int i = 0; i < TransferFunction::kTableSize; ++i) {
    const Material material = material_of(
        transfer.min_value() + range * static_cast<float>(i) / (TransferFunction::kTableSize - 1));
    const auto entry = static_cast<size_t>(i);
    tables->extinction[entry] = material.extinction;
    for (int c = 0; c < 3; ++c) {
      tables->albedo[static_cast<size_t>(c)][entry] = material.albedo[c];
    }
    tables->specular[entry] = material.specular;
    tables->roughness[entry] = material.roughness;
    tables->phase[entry] = material.phase;
  }
  return tables;
}

std::array<float, 256> linear_table() {
  std::array<float, 256> table{};
  for (size_t i = 0; i < table.size(); ++i) {
    table[i] = linear_from_srgb(static_cast<float>(i) / 255.0f);
  }
  return table;
}

}  // namespace

std::uint64_t tracing_memory(const VolumeSize& size) {
  constexpr std::uint64_t kPictures = std::uint64_t{1} << 28;
  // matter_colors(): the scene's, and those of the seed points with what makes them.
  constexpr std::uint64_t kColours = 3 + 3 + 5;
  return VoxelGrid::bytes(size) + MajorantGrid::bytes(size.dims) +
         (size.rgb ? kColours * size.voxels() : 0) + kPictures;
}

std::uint64_t picture_memory(const VolumeSize& size, bool upsample) {
  const VolumeSize fine = most_upsampled(size);
  return !upsample || fine.dims == size.dims
             ? tracing_memory(size)
             : std::max(upsampling_memory(size), fine.loaded() + tracing_memory(fine));
}

CinemaScene::CinemaScene(const Volume& volume, const Preset& preset)
    : volume_(&volume),
      preset_(preset),
      grid_(make_grid(volume, preset)),
      labels_(volume.labels.empty() ? nullptr : std::make_unique<LabelGrid>(volume, preset.labels)),
      majorants_(grid_, preset.transfer, volume.spacing, labels_.get(), preset.gradient_opacity),
      lights_(preset.rig, glm::transpose(volume.direction), Vec3(volume.dims - 1) * volume.spacing),
      inverse_spacing_(1.0f / volume.spacing),
      lift_(mean_spacing(volume.scanned_spacing()) * inverse_spacing_),
      gradient_scale_(grid_.step() / volume.spacing),
      tables_(make_tables(preset.transfer, [&](float value) { return preset.transfer.at(value); })),
      photo_(matter_colors(volume, preset.transfer)) {
  const TransferFunction& transfer = preset_.transfer;
  const float range = transfer.max_value() - transfer.min_value();
  const float per_value = range > 0 ? (TransferFunction::kTableSize - 1) / range : 0.0f;
  entry_scale_ = grid_.step() * per_value;
  entry_offset_ = (grid_.low() - transfer.min_value()) * per_value + 0.5f;
  if (preset_.boundary) {
    boundary_tables_ = make_tables(transfer, [&](float value) {
      return preset_.boundary->mixed(transfer.at(value), value, 1);
    });
  }
}

float CinemaScene::extinction(const Vec3& voxel) const {
  float extinction = tables_->extinction[static_cast<size_t>(entry(grid_.sample(voxel)))];
  if (labels_ != nullptr) {
    extinction *= labels_->mean_opacity(voxel);
  }
  if (preset_.gradient_opacity && extinction > 0) {
    const float steepness = glm::length(grid_.gradient(voxel) * gradient_scale_);
    extinction *= preset_.gradient_opacity->factor(steepness);
  }
  return extinction;
}

Vec3 CinemaScene::photo(const Vec3& voxel) const {
  const Volume& volume = *volume_;
  static const std::array<float, 256> kLinear = linear_table();
  const Vec3 position = glm::clamp(voxel, Vec3(0), Vec3(volume.dims - 1));
  const IVec3 low = IVec3(position);
  const IVec3 high = glm::min(low + 1, volume.dims - 1);
  const Vec3 f = position - Vec3(low);
  Vec3 color(0);
  for (int corner = 0; corner < 8; ++corner) {
    const bool x = (corner & 1) != 0;
    const bool y = (corner & 2) != 0;
    const bool z = (corner & 4) != 0;
    const float weight = (x ? f.x : 1 - f.x) * (y ? f.y : 1 - f.y) * (z ? f.z : 1 - f.z);
    const std::uint8_t* rgb =
        &photo_[3 * volume.offset(x ? high.x : low.x, y ? high.y : low.y, z ? high.z : low.z)];
    color += weight * Vec3(kLinear[rgb[0]], kLinear[rgb[1]], kLinear[rgb[2]]);
  }
  return color;
}

}  // namespace clipgs
