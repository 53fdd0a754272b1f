#include "volume/dicom_series.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <tuple>

#include "core/error.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "volume/dicom_phases.h"
#include "volume/dicom_pixels.h"
#include "volume/stack_plan.h"

namespace clipgs {
namespace {

/// Images of one key lie parallel with equal pixels. Rounding lets the last digits differ.
auto stack_key(const DicomHeader& h) {
  const auto rounded = [](double x) { return std::lround(x * 200); };
  const std::array<long, 6> orientation{rounded(h.row.x),    rounded(h.row.y),
                                        rounded(h.row.z),    rounded(h.column.x),
                                        rounded(h.column.y), rounded(h.column.z)};
  return std::tuple(h.series_uid, h.columns, h.rows, orientation, rounded(h.pixel_spacing.x),
                    rounded(h.pixel_spacing.y));
}

void sort_slices(std::vector<DicomHeader>& slices) {
  const glm::dvec3 normal = normal_of(slices.front());
  std::ranges::stable_sort(slices, [&](const DicomHeader& a, const DicomHeader& b) {
    return std::pair(along_normal(a, normal), a.instance) <
           std::pair(along_normal(b, normal), b.instance);
  });
}

/// Keeps the first (by instance number) of the images that share a position and that nothing sets
/// apart: copies.
void drop_repeats(std::vector<DicomHeader>& slices, const std::string& where) {
  const glm::dvec3 normal = normal_of(slices.front());
  const size_t before = slices.size();
  const auto same = [&](const DicomHeader& a, const DicomHeader& b) {
    return same_place(a, b, normal);
  };
  const auto repeats = std::ranges::unique(slices, same);
  slices.erase(repeats.begin(), repeats.end());
  if (slices.size() < before) {
    warn(fmt::format("{}: {} images share their position with another; the first of each is taken",
                     where, before - slices.size()));
  }
}

/// Made from pictures of the patient rather than being one: segmentations (which may have a frame
/// for each label and slice), doses, maps of fit parameters.
bool is_derived(const DicomStack& stack) {
  constexpr std::array<std::string_view, 4> kDerived{"SEG", "RTDOSE", "REG", "RTSTRUCT"};
  return std::ranges::find(kDerived, stack.modality) != kDerived.end();
}

/// A regular grid that holds every slice: in-plane axes as stored, the third along the normal.
struct ResampleGrid {
  glm::dvec3 normal;
  glm::dvec3 origin;
  IVec3 dims;
  glm::dvec3 spacing;
};

ResampleGrid resample_grid(const std::vector<DicomHeader>& slices, const StackPlan& plan,
                           const std::string& where) {
  const DicomHeader& first = slices.front();
  ResampleGrid grid;
  grid.normal = normal_of(first);
  grid.spacing = glm::dvec3(first.pixel_spacing, plan.step);
  glm::dvec2 low(0);
  glm::dvec2 high(0);
  for (const DicomHeader& slice : slices) {
    const glm::dvec3 shift = slice.position - first.position;
    const glm::dvec2 in_plane =
        glm::dvec2(glm::dot(shift, first.row), glm::dot(shift, first.column)) / first.pixel_spacing;
    low = glm::min(low, in_plane);
    high = glm::max(high, in_plane);
  }
  // Whole pixels, so that an untilted stack keeps its pixels as they are.
  low = glm::floor(low + 1e-3);
  high = glm::ceil(high - 1e-3);
  constexpr double kMostPixels = 1 << 20;  // along one axis: a position far off would take all
  if (!(glm::length(high - low) < kMostPixels)) {
    throw Error("{}: its slices lie {:.3g} mm apart within their planes; the positions are corrupt",
                where, glm::length((high - low) * first.pixel_spacing));
  }
  const double depth = along_normal(slices.back(), grid.normal) - along_normal(first, grid.normal);
  grid.dims = IVec3(first.columns + static_cast<int>(high.x - low.x),
                    first.rows + static_cast<int>(high.y - low.y),
                    1 + static_cast<int>(std::lround(depth / plan.step)));
  grid.origin = first.position + first.row * (low.x * first.pixel_spacing.x) +
                first.column * (low.y * first.pixel_spacing.y);
  return grid;
}

/// One slice's pixels seen from the regular grid, whose in-plane index it is shifted against.
class ShiftedSlice {
 public:
  ShiftedSlice(const DicomHeader& header, std::vector<float> pixels, const ResampleGrid& grid)
      : columns_(header.columns), rows_(header.rows), pixels_(std::move(pixels)) {
    const glm::dvec3 shift = header.position - grid.origin;
    shift_ = glm::dvec2(glm::dot(shift, header.row), glm::dot(shift, header.column)) /
             header.pixel_spacing;
  }

  /// Bilinear value at grid index (x, y), nothing outside the slice.
  std::optional<float> at(int x, int y) const {
    constexpr double kSlack = 1e-3;  // rounding of positions must not cut off a border
    const double u = x - shift_.x;
    const double v = y - shift_.y;
    if (u < -kSlack || v < -kSlack || u > columns_ - 1 + kSlack || v > rows_ - 1 + kSlack) {
      return std::nullopt;
    }
    const int x0 = std::clamp(static_cast<int>(u), 0, columns_ - 2);
    const int y0 = std::clamp(static_cast<int>(v), 0, rows_ - 2);
    const auto s = static_cast<float>(std::clamp(u - x0, 0.0, 1.0));
    const auto t = static_cast<float>(std::clamp(v - y0, 0.0, 1.0));
    const float* p = &pixels_[static_cast<size_t>(y0) * columns_ + x0];
    return glm::mix(glm::mix(p[0], p[1], s), glm::mix(p[columns_], p[columns_ + 1], s), t);
  }

 private:
  int columns_;
  int rows_;
  glm::dvec2 shift_;
  std::vector<float> pixels_;
};

void warn_of_resampling(const StackPlan& plan, const ResampleGrid& grid,
                        const std::vector<DicomHeader>& slices, const std::string& where) {
  if (!plan.gaps.empty()) {
    warn(fmt::format("{}: {}; interpolated from their neighbours (--gaps refuse stops instead)",
                     where, describe_gaps(plan, slices)));
  }
  if (!plan.sheared && !plan.uneven) {
    return;
  }
  std::string why;
  if (plan.sheared) {
    why = fmt::format("gantry tilted by {:.1f} degrees", plan.tilt_deg);
  }
  if (plan.uneven) {
    why += fmt::format("{}slices {:.2f} to {:.2f} mm apart", why.empty() ? "" : " and ",
                       plan.smallest_step, plan.largest_step);
  }
  warn(
      fmt::format("{}: {}: resampled to a regular grid of {} x {} x {} voxels, {:.3f} x {:.3f} x "
                  "{:.3f} mm",
                  where, why, grid.dims.x, grid.dims.y, grid.dims.z, grid.spacing.x, grid.spacing.y,
                  grid.spacing.z));
}

/// Linear between the two slices around each plane of the grid; where only one of them has data,
/// that one's value.
void resample_stack(const DicomStack& stack, const ResampleGrid& grid, float fill,
                    std::vector<float>& values) {
  const std::vector<DicomHeader>& slices = stack.slices;
  const double start = along_normal(slices.front(), grid.normal);
  DicomPixels pixels(fill);
  const auto load = [&](size_t i) { return ShiftedSlice(slices[i], pixels.read(slices[i]), grid); };
  size_t below = 0;
  ShiftedSlice low = load(0);
  ShiftedSlice high = load(1);
  const size_t plane = static_cast<size_t>(grid.dims.x) * grid.dims.y;
  Progress progress("reading", static_cast<size_t>(grid.dims.z));
  for (int z = 0; z < grid.dims.z; ++z) {
    const double depth = start + z * grid.spacing.z;
    while (below + 2 < slices.size() && along_normal(slices[below + 1], grid.normal) <= depth) {
      ++below;
      low = std::move(high);
      high = load(below + 1);
    }
    const double near_depth = along_normal(slices[below], grid.normal);
    const double far_depth = along_normal(slices[below + 1], grid.normal);
    const auto t =
        static_cast<float>(std::clamp((depth - near_depth) / (far_depth - near_depth), 0.0, 1.0));
    float* out = &values[plane * z];
    parallel_for(static_cast<size_t>(grid.dims.y), 16, [&](size_t begin, size_t end) {
      for (size_t row = begin; row < end; ++row) {
        for (int x = 0; x < grid.dims.x; ++x) {
          const std::optional<float> a = low.at(x, static_cast<int>(row));
          const std::optional<float> b = high.at(x, static_cast<int>(row));
          float& value = out[row * grid.dims.x + x];
          value = a && b ? glm::mix(*a, *b, t) : a ? *a : b.value_or(fill);
        }
      }
    });
    progress.update(static_cast<size_t>(z) + 1);
  }
}

VoxelValues read_regular(const DicomStack& stack, float fill, size_t voxels) {
  Progress progress("reading", stack.slices.size());
  ValuePacker packer(voxels);
  DicomPixels pixels(fill);
  for (size_t i = 0; i < stack.slices.size(); ++i) {
    packer.append(pixels.read(stack.slices[i]));
    progress.update(i + 1);
  }
  return packer.take();
}

/// Of the read volume. Slices that are scaled each in its own way (PET) have together more values
/// than 16 bits tell apart.
int bytes_of_a_value(const std::vector<DicomHeader>& slices, const StackPlan& plan) {
  const DicomHeader& first = slices.front();
  const bool alike = std::ranges::all_of(slices, [&](const DicomHeader& slice) {
    return slice.slope == first.slope && slice.intercept == first.intercept;
  });
  return plan.resampled() || !alike ? int{sizeof(float)} : first.bits_allocated / 8;
}

void require_whole(const DicomStack& stack, const std::string& where) {
  const DicomHeader& first = stack.slices.front();
  if (stack.slices.size() < 2 || first.columns < 2 || first.rows < 2) {
    throw Error(
        "{}: the series has {} slice(s) of {} x {} pixels; a volume needs at least 2 along "
        "every axis",
        where, stack.slices.size(), first.columns, first.rows);
  }
  const double skew = std::abs(glm::dot(first.row, first.column));
  if (std::abs(glm::length(first.row) - 1) > 1e-2 ||
      std::abs(glm::length(first.column) - 1) > 1e-2 || skew > 1e-2) {
    throw Error("{}: the slices' orientation is not made of perpendicular unit vectors",
                first.source.name());
  }
}

/// A stack on the grid of its volume, all but the voxels.
struct LaidOutStack {
  DicomStack whole;  ///< without repeats
  StackPlan plan;
  ResampleGrid grid;
  StoredImage image;

  VolumeSize size() const {
    return {.dims = image.dims,
            .stored_bytes = bytes_of_a_value(whole.slices, plan),
            .spacing = Vec3(image.spacing)};
  }
};

LaidOutStack lay_out(DicomStack stack, Gaps gaps, const std::string& where) {
  drop_repeats(stack.slices, where);
  require_whole(stack, where);
  StackPlan plan = plan_stack(stack.slices, gaps, where);
  const ResampleGrid grid = resample_grid(stack.slices, plan, where);

  StoredImage image;
  const DicomHeader& first = stack.slices.front();
  image.direction = glm::dmat3(first.row, first.column, grid.normal);
  image.dims = plan.resampled()
                   ? grid.dims
                   : IVec3(first.columns, first.rows, static_cast<int>(stack.slices.size()));
  image.spacing = grid.spacing;
  image.origin = plan.resampled() ? grid.origin : first.position;
  image.hints = first.hints;
  if (static_cast<std::uint64_t>(image.dims.x) * image.dims.y * image.dims.z > kMaxVoxels) {
    throw Error("{}: more than 2^32 voxels; crop or downsample the series", where);
  }
  return {std::move(stack), std::move(plan), grid, std::move(image)};
}

}  // namespace

std::uint64_t DicomStack::voxels() const {
  const DicomHeader& first = slices.front();
  return static_cast<std::uint64_t>(slices.size()) * first.columns * first.rows;
}

std::string DicomStack::describe() const {
  const DicomHeader& first = slices.front();
  return fmt::format("{}, series {}, {}{}{} slices of {} x {}", modality.empty() ? "?" : modality,
                     series_number, phase, phase.empty() ? "" : ", ", slices.size(), first.columns,
                     first.rows);
}

std::vector<DicomStack> group_into_stacks(const std::vector<DicomHeader>& headers) {
  using Key = decltype(stack_key(headers.front()));
  std::map<std::pair<Key, std::string>, DicomStack> stacks;
  for (const DicomHeader& header : headers) {
    if (!header.placed) {
      continue;
    }
    // A file of many frames is a volume, or volumes, of its own.
    DicomStack& stack =
        stacks[{stack_key(header), header.frames > 1 ? header.source.name() : std::string()}];
    stack.uid = header.series_uid;
    stack.modality = header.modality;
    stack.series_number = header.series_number;
    stack.slices.push_back(header);
  }
  std::vector<DicomStack> sorted;
  for (auto& [key, stack] : stacks) {
    sort_slices(stack.slices);
    for (DicomPhase& phase : split_phases(std::move(stack.slices))) {
      sorted.push_back({stack.uid, stack.modality, stack.series_number, std::move(phase.name),
                        std::move(phase.slices)});
    }
  }
  std::ranges::stable_sort(sorted, [](const DicomStack& a, const DicomStack& b) {
    return std::pair(is_derived(a), b.voxels()) < std::pair(is_derived(b), a.voxels());
  });
  return sorted;
}

VolumeSize stack_size(const DicomStack& stack, Gaps gaps, const std::string& where) {
  return lay_out(stack, gaps, where).size();
}

StoredImage read_stack(const DicomStack& stack, float fill, Gaps gaps, const std::string& where,
                       const SizeCheck& check) {
  LaidOutStack laid = lay_out(stack, gaps, where);
  if (check) {
    check(laid.size());
  }
  StoredImage& image = laid.image;
  const auto voxels = static_cast<size_t>(image.dims.x) * image.dims.y * image.dims.z;
  if (laid.plan.resampled()) {
    warn_of_resampling(laid.plan, laid.grid, laid.whole.slices, where);
    std::vector<float> values(voxels);
    resample_stack(laid.whole, laid.grid, fill, values);
    image.values = std::move(values);
  } else {
    image.values = read_regular(laid.whole, fill, voxels);
  }
  return std::move(laid.image);
}

}  // namespace clipgs
