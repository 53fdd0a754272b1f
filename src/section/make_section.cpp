#include <algorithm>
#include <cmath>

#include "cinema/visible_matter.h"
#include "core/error.h"
#include "core/image.h"
#include "core/parallel.h"
#include "section/error_bands.h"
#include "section/field.h"
#include "section/section.h"
#include "volume/preset.h"
#include "volume/slice_flood.h"

namespace clipgs {
namespace {

/// The box of voxel centres of the volume that a section covers, and its own grid within.
struct Grid {
  IVec3 low, high;  // voxels of the volume, inclusive
  IVec3 dims;
  Vec3 spacing;  // mm
};

Grid plan_grid(const Volume& volume, const VisibleMatter& matter, int size) {
  constexpr float kMargin = 2;  // voxels: interpolation and resampling reach beyond the matter
  Vec3 first(volume.dims);
  Vec3 last(0);
  for (const Vec3& point : matter.hull) {
    const Vec3 index = volume.index_from_world(point);
    first = glm::min(first, index);
    last = glm::max(last, index);
  }
  Grid grid;
  grid.low = IVec3(glm::clamp(glm::floor(first - kMargin), Vec3(0), Vec3(volume.dims - 1)));
  grid.high = IVec3(glm::clamp(glm::ceil(last + kMargin), Vec3(0), Vec3(volume.dims - 1)));
  const Vec3 extent = Vec3(grid.high - grid.low) * volume.spacing;
  for (int k = 0; k < 3; ++k) {
    const int steps = std::min(grid.high[k] - grid.low[k], size - 1);
    grid.dims[k] = steps + 1;
    grid.spacing[k] = steps > 0 ? extent[k] / static_cast<float>(steps) : volume.spacing[k];
  }
  return grid;
}

/// `get(offset)` of the volume's voxels inside the grid's box, resampled to the grid.
template <typename Get>
Field resample_volume(const Volume& volume, const Grid& grid, const Get& get) {
  const IVec3 box = grid.high - grid.low + 1;
  return resample_rows(box, grid.dims, [&](int y, int z, float* row) {
    const size_t from = volume.offset(grid.low.x, grid.low.y + y, grid.low.z + z);
    for (int x = 0; x < box.x; ++x) {
      row[x] = get(from + static_cast<size_t>(x));
    }
  });
}

/// Whether a value can be that of the air around the body. What the preset hides is no air for
/// that: in grey it is looked at.
bool may_be_air(float value, const Volume& volume, const TransferFunction& transfer) {
  constexpr float kMostAir = -400;  // HU
  const bool hidden = transfer.at(value).extinction <= 0;
  return hidden && (volume.modality != Modality::kCt || value < kMostAir);
}

/// 1 where there is no air within `reach` voxels along every axis.
template <typename IsAir>
std::vector<std::uint8_t> near_matter(const Field& field, const IsAir& is_air, int reach) {
  std::vector<std::uint8_t> mask(field.values.size());
  for (size_t i = 0; i < mask.size(); ++i) {
    mask[i] = is_air(field.values[i]) ? 0 : 1;
  }
  const std::array<size_t, 3> strides = {1, static_cast<size_t>(field.dims.x),
                                         static_cast<size_t>(field.dims.x) * field.dims.y};
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<std::uint8_t> wider = mask;
    for (int z = 0; z < field.dims.z; ++z) {
      for (int y = 0; y < field.dims.y; ++y) {
        for (int x = 0; x < field.dims.x; ++x) {
          const size_t at = field.offset(x, y, z);
          if (mask[at] == 0) {
            continue;
          }
          const int place = IVec3(x, y, z)[axis];
          const int first = std::max(-reach, -place);
          const int last = std::min(reach, field.dims[axis] - 1 - place);
          for (int i = first; i <= last; ++i) {
            wider[at + static_cast<size_t>(i) * strides[axis]] = 1;
          }
        }
      }
    }
    mask = std::move(wider);
  }
  return mask;
}

/// 1 for the air around the body: what a flood from the borders of each slice reaches. Air inside,
/// as in the lungs, is not: its values are worth reading.
template <typename IsAir>
std::vector<std::uint8_t> outside(const Field& field, const IsAir& is_air) {
  constexpr int kReach = 1;  // interpolation at the surface needs the values on both sides
  return flood_slices(field.dims, near_matter(field, is_air, kReach));
}

/// How a value looks on a face: display sRGB under white light, and opacity of half a voxel.
Vec4 look(const Preset& preset, float value, float half_voxel) {
  const Material& m = preset.transfer.at(value);
  const auto shown = [&](float albedo) {
    return display_from_linear(preset.exposure * albedo, preset.tone);
  };
  return {shown(m.albedo.r), shown(m.albedo.g), shown(m.albedo.b),
          1 - std::exp(-m.extinction * half_voxel)};
}

ValueCurve curve_for(const std::vector<float>& values, const Preset& preset, float half_voxel) {
  const auto [least, most] = std::ranges::minmax_element(values);
  constexpr size_t kBins = 4096;
  ValueImportance importance;
  importance.low = *least;
  importance.high = std::max(*most, *least + 1e-3f);
  importance.frequency.assign(kBins, 0.0);
  importance.sensitivity.resize(kBins);
  const float width = (importance.high - importance.low) / kBins;
  for (const float value : values) {
    const auto bin = static_cast<size_t>((value - importance.low) / width);
    importance.frequency[std::min(bin, kBins - 1)] += 1;
  }
  // Seen in grey, a quarter of the range fills the display.
  const float grey = 4 / (importance.high - importance.low);
  for (size_t i = 0; i < kBins; ++i) {
    const float at = importance.low + (static_cast<float>(i) + 0.5f) * width;
    const Vec4 change = look(preset, at + width, half_voxel) - look(preset, at - width, half_voxel);
    const float seen = glm::length(change) / (2 * width);
    importance.sensitivity[i] = std::hypot(grey, seen);
  }
  return fit_value_curve(importance, Section::kFirstInside);
}

/// Of matter, not of the air around it.
std::uint8_t nearest_code(float code) {
  return static_cast<std::uint8_t>(
      std::lround(std::clamp(code, static_cast<float>(Section::kFirstInside), 255.0f)));
}

Vec3 diffuse_of(const Material& m) { return (1 - m.specular) * m.albedo; }

std::array<FaceMaterial, ValueCurve::kCodes> materials_of(const Preset& preset,
                                                          const ValueCurve& curve) {
  std::array<FaceMaterial, ValueCurve::kCodes> materials;
  for (size_t i = 0; i < materials.size(); ++i) {
    const float value = curve.values()[i];
    const Material& m = preset.transfer.at(value);
    const Vec3 diffuse = diffuse_of(m);
    materials[i] = {m.extinction, m.specular, m.roughness, diffuse, diffuse};
    if (preset.boundary) {
      materials[i].boundary = diffuse_of(preset.boundary->mixed(m, value, 1));
    }
  }
  return materials;
}

/// The errors of all slices, which `add(z, errors)` collects one by one.
template <typename Add>
ErrorBands over_slices(int slices, const Add& add) {
  std::vector<ErrorBands> errors(static_cast<size_t>(slices));
  parallel_for(errors.size(), 1, [&](size_t z, size_t) { add(static_cast<int>(z), errors[z]); });
  ErrorBands sum;
  for (const ErrorBands& slice : errors) {
    sum.add(slice);
  }
  return sum;
}

/// What reading values back from the section gets wrong, over the volume's voxels.
ErrorBands reading_errors(const Section& section, const Volume& volume, const Grid& grid) {
  return over_slices(grid.high.z - grid.low.z + 1, [&](int slice, ErrorBands& errors) {
    const int z = grid.low.z + slice;
    for (int y = grid.low.y; y <= grid.high.y; ++y) {
      for (int x = grid.low.x; x <= grid.high.x; ++x) {
        const Vec3 index = section.index_from_world(volume.world_from_index(Vec3(x, y, z)));
        if (section.code(index) >= Section::kFirstInside) {
          const float value = section.value(section.sample(index));
          errors.add(section.curve.code(value), value - volume.readings()[volume.offset(x, y, z)]);
        }
      }
    }
  });
}

/// What a section tells otherwise than a finer one of the same box.
ErrorBands resizing_errors(const Section& fine, const Section& coarse) {
  const Vec3 ratio = fine.spacing / coarse.spacing;
  return over_slices(fine.dims.z, [&](int z, ErrorBands& errors) {
    for (int y = 0; y < fine.dims.y; ++y) {
      for (int x = 0; x < fine.dims.x; ++x) {
        const Vec3 at(x, y, z);
        if (coarse.code(at * ratio) >= Section::kFirstInside) {
          const float told = coarse.value(coarse.sample(at * ratio));
          errors.add(coarse.curve.code(told), told - fine.value(fine.sample(at)));
        }
      }
    }
  });
}

void fill_scalar(Section& section, const Volume& volume, const Preset& preset, const Grid& grid) {
  const Field field = resample_volume(volume, grid, [&](size_t i) { return volume.readings()[i]; });
  const std::vector<std::uint8_t> air =
      outside(field, [&](float value) { return may_be_air(value, volume, preset.transfer); });
  std::vector<float> inside;
  for (size_t i = 0; i < air.size(); ++i) {
    if (air[i] == 0) {
      inside.push_back(field.values[i]);
    }
  }
  section.curve = curve_for(inside, preset, 0.5f * mean_spacing(volume.spacing));
  section.voxels.resize(field.values.size());
  for (size_t i = 0; i < air.size(); ++i) {
    section.voxels[i] = air[i] != 0 ? 0 : nearest_code(section.curve.code(field.values[i]));
  }
}

void require_size(int size) {
  if (size < 8 || size > 1024) {
    throw Error("section: a size of {} voxels is out of range; use 8 to 1024", size);
  }
}

void fill_rgb(Section& section, const Volume& volume, const Grid& grid) {
  section.channels = 3;
  section.voxels.resize(section.voxel_count() * 3);
  for (size_t c = 0; c < 3; ++c) {
    const Field field = resample_volume(
        volume, grid, [&](size_t i) { return static_cast<float>(volume.rgb[3 * i + c]); });
    for (size_t i = 0; i < field.values.size(); ++i) {
      section.voxels[3 * i + c] = static_cast<std::uint8_t>(std::lround(field.values[i]));
    }
  }
}

}  // namespace

Section make_section(const Volume& volume, const Preset& preset, const SectionOptions& options) {
  require_size(options.size);
  const Grid grid = plan_grid(volume, visible_matter(volume, preset.transfer), options.size);
  Section section;
  section.dims = grid.dims;
  section.spacing = grid.spacing;
  section.direction = volume.direction;
  section.origin = volume.world_from_index(Vec3(grid.low));
  section.modality = volume.modality;
  section.source_spacing = volume.spacing;
  section.rig = preset.rig;
  section.exposure = preset.exposure;
  section.tone = preset.tone;
  if (volume.rgb.empty()) {
    fill_scalar(section, volume, preset, grid);
  } else {
    fill_rgb(section, volume, grid);
  }
  section.materials = materials_of(preset, section.curve);
  if (preset.boundary) {
    section.steep = preset.boundary->range;
  }
  section.value_errors = reading_errors(section, volume, grid).on_top_of({});
  return section;
}

std::uint64_t section_memory(const VolumeSize& volume, const SectionOptions& options) {
  const IVec3 dims = glm::min(volume.dims, IVec3(options.size));
  const auto points = [](int x, int y, int z) {
    return static_cast<std::uint64_t>(x) * static_cast<std::uint64_t>(y) *
           static_cast<std::uint64_t>(z);
  };
  // Floats are resampled axis by axis; then come the values inside, three masks and the codes.
  const std::uint64_t rows = sizeof(float) * points(dims.x, volume.dims.y, volume.dims.z);
  const std::uint64_t planes = sizeof(float) * points(dims.x, dims.y, volume.dims.z);
  const std::uint64_t section = points(dims.x, dims.y, dims.z);
  return std::max(
      {rows + planes, planes + sizeof(float) * section, (2 * sizeof(float) + 4) * section});
}

Section resize_section(const Section& section, int size) {
  require_size(size);
  const Vec3 steps = Vec3(section.dims - 1);
  const Vec3 extent = steps * section.spacing;
  Section small = section;
  for (int k = 0; k < 3; ++k) {
    small.dims[k] = std::min(section.dims[k], size);
    small.spacing[k] = extent[k] / static_cast<float>(std::max(1, small.dims[k] - 1));
  }
  if (small.dims == section.dims) {
    return section;
  }
  small.voxels.resize(small.voxel_count() * static_cast<size_t>(small.channels));
  // What `meaning` says of a channel's codes, resampled.
  const auto resampled = [&](size_t channel, const auto& meaning) {
    Field field{section.dims, std::vector<float>(section.voxel_count())};
    for (size_t i = 0; i < field.values.size(); ++i) {
      field.values[i] = meaning(section.voxels[section.channels * i + channel]);
    }
    return resample(std::move(field), small.dims).values;
  };
  if (section.channels == 1) {
    const std::vector<float> values =
        resampled(0, [&](std::uint8_t code) { return section.curve.values()[code]; });
    const std::vector<float> inside =
        resampled(0, [](std::uint8_t code) { return code >= Section::kFirstInside ? 1.0f : 0.0f; });
    for (size_t i = 0; i < values.size(); ++i) {
      small.voxels[i] = inside[i] < 0.5f ? 0 : nearest_code(section.curve.code(values[i]));
    }
  } else {
    for (size_t c = 0; c < 3; ++c) {
      const std::vector<float> levels =
          resampled(c, [](std::uint8_t level) { return static_cast<float>(level); });
      for (size_t i = 0; i < levels.size(); ++i) {
        small.voxels[3 * i + c] = static_cast<std::uint8_t>(std::lround(levels[i]));
      }
    }
  }
  small.value_errors = resizing_errors(section, small).on_top_of(section.value_errors);
  return small;
}

}  // namespace clipgs
