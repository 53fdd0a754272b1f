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
#include "volume/upsample.h"

namespace clipgs {
namespace {

constexpr float kOnGrid = 1e-3f;  // voxels: rounding

/// The box of voxel centres of the volume that a section covers, and its own grid within.
struct Grid {
  IVec3 low, high;  // voxels of the volume, inclusive
  IVec3 stride;     // of the volume's voxels, that resampling starts from
  IVec3 dims;
  Vec3 spacing;  // mm
};

std::uint64_t points_of(const IVec3& dims) {
  return static_cast<std::uint64_t>(dims.x) * static_cast<std::uint64_t>(dims.y) *
         static_cast<std::uint64_t>(dims.z);
}

std::uint64_t most_voxels(int size) { return points_of(IVec3(size)); }

/// The finest grid of no more than size³ points, as even along the axes as it may be, in place of
/// one of `dims` points that are `spacing` mm apart.
IVec3 fitting_dims(const IVec3& dims, const Vec3& spacing, int size) {
  const auto at_most_as_fine_as = [&](float goal) {
    const Vec3 steps = glm::floor(Vec3(dims - 1) * glm::min(spacing / goal, Vec3(1)));
    return glm::min(dims, IVec3(steps) + 1);
  };
  float fine = 0.5f * std::min({spacing.x, spacing.y, spacing.z});
  if (points_of(at_most_as_fine_as(fine)) <= most_voxels(size)) {
    return dims;
  }
  const Vec3 extent = Vec3(dims) * spacing;
  float coarse = std::max({extent.x, extent.y, extent.z});
  for (int i = 0; i < 40; ++i) {
    const float middle = 0.5f * (fine + coarse);
    (points_of(at_most_as_fine_as(middle)) <= most_voxels(size) ? coarse : fine) = middle;
  }
  return at_most_as_fine_as(coarse);
}

/// The axis along which voxels lie closest of those that are finer than the scanned ones, if any.
std::optional<int> finest_axis(const Volume& volume, const IVec3& stride) {
  std::optional<int> finest;
  for (int k = 0; k < 3; ++k) {
    const auto apart = [&](int axis) {
      return volume.spacing[axis] * static_cast<float>(stride[axis]);
    };
    if (stride[k] < volume.upsampling[k] && (!finest || apart(k) < apart(*finest))) {
      finest = k;
    }
  }
  return finest;
}

/// Whole voxels as scanned, so that what is between them can be left out.
Grid plan_grid(const Volume& volume, const VisibleMatter& matter, int size) {
  constexpr float kMargin = 2;  // voxels: interpolation and resampling reach beyond the matter
  const Vec3 scanned(volume.upsampling);
  Vec3 first(volume.dims);
  Vec3 last(0);
  for (const Vec3& point : matter.hull) {
    const Vec3 index = volume.index_from_world(point);
    first = glm::min(first, index);
    last = glm::max(last, index);
  }
  const auto voxel = [&](const Vec3& at) {
    return glm::clamp(IVec3(at) * volume.upsampling, IVec3(0), volume.dims - 1);
  };
  Grid grid;
  grid.low = voxel(glm::max(glm::floor(first / scanned - kMargin), Vec3(0)));
  grid.high = voxel(glm::ceil(last / scanned + kMargin));
  grid.stride = IVec3(1);
  const auto strided = [&] { return (grid.high - grid.low) / grid.stride + 1; };
  for (auto axis = finest_axis(volume, grid.stride);
       axis && points_of(strided()) > most_voxels(size); axis = finest_axis(volume, grid.stride)) {
    int& stride = grid.stride[*axis];
    do {
      ++stride;
    } while (volume.upsampling[*axis] % stride != 0);
  }
  const Vec3 extent = Vec3(grid.high - grid.low) * volume.spacing;
  grid.dims = fitting_dims(strided(), volume.spacing * Vec3(grid.stride), size);
  for (int k = 0; k < 3; ++k) {
    const int steps = grid.dims[k] - 1;
    grid.spacing[k] = steps > 0 ? extent[k] / static_cast<float>(steps) : volume.spacing[k];
  }
  return grid;
}

/// `get(voxel)` of the volume inside the grid's box, resampled to the grid.
template <typename Get>
Field resample_volume(const Grid& grid, const Get& get) {
  const IVec3 box = (grid.high - grid.low) / grid.stride + 1;
  return resample_rows(box, grid.dims, [&](int y, int z, float* row) {
    for (int x = 0; x < box.x; ++x) {
      row[x] = get(grid.low + IVec3(x, y, z) * grid.stride);
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

/// What make(i) says of each of `count` places, on all threads.
template <typename Make>
std::vector<std::uint8_t> at_each(size_t count, const Make& make) {
  std::vector<std::uint8_t> all(count);
  parallel_for(count, size_t{1} << 16, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      all[i] = static_cast<std::uint8_t>(make(i));
    }
  });
  return all;
}

/// 1 where not all is air of a voxel and those beside it, diagonally as well.
template <typename IsAir>
std::vector<std::uint8_t> near_matter(const Field& field, const IsAir& is_air) {
  std::vector<std::uint8_t> mask =
      at_each(field.values.size(), [&](size_t i) { return is_air(field.values[i]) ? 0 : 1; });
  const std::array<size_t, 3> strides = {1, static_cast<size_t>(field.dims.x),
                                         static_cast<size_t>(field.dims.x) * field.dims.y};
  for (int axis = 0; axis < 3; ++axis) {
    const size_t stride = strides[static_cast<size_t>(axis)];
    const auto length = static_cast<size_t>(field.dims[axis]);
    mask = at_each(mask.size(), [&](size_t i) {
      const size_t place = i / stride % length;
      const int before = place > 0 ? mask[i - stride] : 0;
      const int after = place + 1 < length ? mask[i + stride] : 0;
      return before | mask[i] | after;
    });
  }
  return mask;
}

/// 1 for the air around the body: what a flood from the borders of each slice reaches. Air inside,
/// as in the lungs, is not: its values are worth reading.
template <typename IsAir>
std::vector<std::uint8_t> outside(const Field& field, const IsAir& is_air) {
  // Interpolation at the surface needs the values on both sides.
  return flood_slices(field.dims, near_matter(field, is_air));
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

/// What reading values back from the section gets wrong, over the scanned voxels in its box: of
/// large volumes in every third row, another third in each slice, so that no pattern of the
/// section's grid is missed.
ErrorBands reading_errors(const Section& section, const Volume& scanned) {
  constexpr std::uint64_t kAllOf = 8'000'000;  // voxels
  const int step = scanned.voxels() > kAllOf ? 3 : 1;
  const Vec3 last = Vec3(section.dims - 1);
  return over_slices(scanned.dims.z, [&](int z, ErrorBands& errors) {
    for (int y = z % step; y < scanned.dims.y; y += step) {
      for (int x = 0; x < scanned.dims.x; ++x) {
        const Vec3 index = section.index_from_world(scanned.world_from_index(Vec3(x, y, z)));
        const bool inside = glm::all(glm::greaterThanEqual(index, Vec3(-kOnGrid))) &&
                            glm::all(glm::lessThanEqual(index, last + kOnGrid));
        if (inside && section.code(index) >= Section::kFirstInside) {
          const float value = section.value(section.sample(index));
          errors.add(section.curve.code(value),
                     value - scanned.readings()[scanned.offset(x, y, z)]);
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

void fill_scalar(Section& section, const Volume& traced, const Volume& scanned,
                 const Preset& preset, const Grid& grid) {
  // What is read of the scanned voxels and left out of the pictures, between them.
  const auto left_out = [&](const IVec3& at) {
    if (scanned.scanned.empty()) {
      return 0.0f;
    }
    const Vec3 world = traced.world_from_index(Vec3(at));
    return scanned.sample(scanned.scanned, world) - scanned.sample(world);
  };
  const Field field = resample_volume(
      grid, [&](const IVec3& at) { return traced.at(at.x, at.y, at.z) + left_out(at); });
  const std::vector<std::uint8_t> air =
      outside(field, [&](float value) { return may_be_air(value, traced, preset.transfer); });
  std::vector<float> inside;
  for (size_t i = 0; i < air.size(); ++i) {
    if (air[i] == 0) {
      inside.push_back(field.values[i]);
    }
  }
  section.curve = curve_for(inside, preset, 0.5f * mean_spacing(section.source_spacing));
  section.voxels = at_each(air.size(), [&](size_t i) {
    return air[i] != 0 ? std::uint8_t{0} : nearest_code(section.curve.code(field.values[i]));
  });
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
    const Field field = resample_volume(grid, [&](const IVec3& at) {
      return static_cast<float>(volume.rgb[3 * volume.offset(at.x, at.y, at.z) + c]);
    });
    for (size_t i = 0; i < field.values.size(); ++i) {
      section.voxels[3 * i + c] = static_cast<std::uint8_t>(std::lround(field.values[i]));
    }
  }
}

}  // namespace

Section make_section(const Volume& traced, const Volume& scanned, const Preset& preset,
                     const SectionOptions& options) {
  require_size(options.size);
  const Grid grid = plan_grid(traced, visible_matter(traced, preset.transfer), options.size);
  Section section;
  section.dims = grid.dims;
  section.spacing = grid.spacing;
  section.direction = traced.direction;
  section.origin = traced.world_from_index(Vec3(grid.low));
  section.modality = traced.modality;
  section.source_spacing = traced.scanned_spacing();
  section.rig = preset.rig;
  section.exposure = preset.exposure;
  section.tone = preset.tone;
  if (traced.rgb.empty()) {
    fill_scalar(section, traced, scanned, preset, grid);
  } else {
    fill_rgb(section, traced, grid);
  }
  section.materials = materials_of(preset, section.curve);
  if (preset.boundary) {
    section.steep = preset.boundary->range;
  }
  section.value_errors = reading_errors(section, scanned).on_top_of({});
  return section;
}

Section make_section(const Volume& volume, const Preset& preset, const SectionOptions& options) {
  return make_section(volume, volume, preset, options);
}

std::uint64_t section_memory(const VolumeSize& scanned, const SectionOptions& options) {
  const std::uint64_t section =
      std::min(most_upsampled(scanned).voxels(), most_voxels(options.size));
  // Floats are resampled axis by axis, of rows that are shortened as they are read; then come the
  // values inside, three masks and the codes.
  const IVec3 fitting = fitting_dims(scanned.dims, scanned.spacing, options.size);
  const std::uint64_t rows = points_of({fitting.x, scanned.dims.y, scanned.dims.z});
  const std::uint64_t columns = points_of({fitting.x, fitting.y, scanned.dims.z});
  const std::uint64_t resampled = std::max(rows + columns, 2 * section);
  return std::max(sizeof(float) * resampled, (2 * sizeof(float) + 4) * section);
}

std::uint64_t held_section_memory(const VolumeSize& scanned, const SectionOptions& options) {
  return (scanned.rgb ? 3 : 1) *
         std::min(most_upsampled(scanned).voxels(), most_voxels(options.size));
}

Section resize_section(const Section& section, int size) {
  require_size(size);
  const Vec3 steps = Vec3(section.dims - 1);
  const Vec3 extent = steps * section.spacing;
  Section small = section;
  small.dims = fitting_dims(section.dims, section.spacing, size);
  for (int k = 0; k < 3; ++k) {
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
