#include "cinema/majorant_grid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"

namespace clipgs {
namespace {

constexpr std::uint32_t kMinus = 0x80000000;  // sign of a float

// A float that is at least as large as `x` >= 0 and all in its upper 16 bits.
std::uint32_t rounded_up(float x) {
  return (std::bit_cast<std::uint32_t>(x) + 0xffffU) &
         static_cast<std::uint32_t>(MajorantGrid::kBoundBits);
}

// The largest `of(x, y, z)` of the voxels from … to, both included.
template <typename Of>
float largest(const IVec3& from, const IVec3& to, const Of& of) {
  float result = 0;
  for (int z = from.z; z <= to.z; ++z) {
    for (int y = from.y; y <= to.y; ++y) {
      for (int x = from.x; x <= to.x; ++x) {
        result = std::max(result, of(x, y, z));
      }
    }
  }
  return result;
}

}  // namespace

// What the extinction of the values is multiplied by.
class MajorantGrid::Thinning {
 public:
  Thinning(const VoxelGrid& grid, const Vec3& spacing, const LabelGrid* labels,
           const std::optional<GradientOpacity>& gradient_opacity)
      : grid_(grid),
        labels_(labels),
        gradient_opacity_(gradient_opacity),
        gradient_scale_(grid.step() / spacing) {}

  // At most, between the voxels from … to, both included; indices in [0, dims].
  float most(const IVec3& from, const IVec3& to) const {
    float factor = 1;
    if (labels_ != nullptr) {
      factor *= largest(from, to, [&](int x, int y, int z) { return labels_->opacity(x, y, z); });
    }
    if (gradient_opacity_) {
      const float squared =
          largest(from, to, [&](int x, int y, int z) { return squared_steepness({x, y, z}); });
      // One code of margin for the rounding of interpolation.
      factor *= gradient_opacity_->factor(std::sqrt(squared) + glm::length(gradient_scale_));
    }
    return factor;
  }

 private:
  // Between voxels, central differences are interpolated from theirs: never steeper.
  float squared_steepness(IVec3 at) const {
    at = glm::min(at, grid_.dims() - 1);  // beyond, the edge goes on
    const auto code = [&](int dx, int dy, int dz) {
      return static_cast<float>(grid_.code(at.x + dx, at.y + dy, at.z + dz));
    };
    const Vec3 gradient = 0.5f * gradient_scale_ *
                          Vec3(code(1, 0, 0) - code(-1, 0, 0), code(0, 1, 0) - code(0, -1, 0),
                               code(0, 0, 1) - code(0, 0, -1));
    return glm::dot(gradient, gradient);
  }

  const VoxelGrid& grid_;
  const LabelGrid* labels_;
  const std::optional<GradientOpacity>& gradient_opacity_;
  Vec3 gradient_scale_;  // value units per mm of a code per voxel
};

MajorantGrid::MajorantGrid(const VoxelGrid& grid, const TransferFunction& transfer,
                           const Vec3& spacing, const LabelGrid* labels,
                           const std::optional<GradientOpacity>& gradient_opacity)
    : nudge_(1e-3f * std::min({spacing.x, spacing.y, spacing.z})) {
  cells_.count = (grid.dims() + kCell - 1) / kCell;
  cells_.stride_y = cells_.count.x;
  cells_.stride_z = cells_.count.x * cells_.count.y;
  const size_t count = static_cast<size_t>(cells_.stride_z) * static_cast<size_t>(cells_.count.z);
  cells_.words.assign(count, 0);
  const Thinning thinning(grid, spacing, labels, gradient_opacity);
  find_majorants(grid, transfer, thinning);
  find_matter(grid, transfer, thinning);
  find_distances();
}

void MajorantGrid::find_majorants(const VoxelGrid& grid, const TransferFunction& transfer,
                                  const Thinning& thinning) {
  const IVec3 last = grid.dims() - 1;
  parallel_for(static_cast<size_t>(cells_.count.z), 1, [&](size_t begin, size_t) {
    const int cz = static_cast<int>(begin);
    for (int cy = 0; cy < cells_.count.y; ++cy) {
      for (int cx = 0; cx < cells_.count.x; ++cx) {
        const IVec3 from = IVec3(cx, cy, cz) * kCell;
        const IVec3 to = glm::min(from + kCell, last);  // inclusive: the cells share a border
        std::uint16_t low = std::numeric_limits<std::uint16_t>::max();
        std::uint16_t high = 0;
        for (int z = from.z; z <= to.z; ++z) {
          for (int y = from.y; y <= to.y; ++y) {
            for (int x = from.x; x <= to.x; ++x) {
              const std::uint16_t code = grid.code(x, y, z);
              low = std::min(low, code);
              high = std::max(high, code);
            }
          }
        }
        // One code of margin for the rounding of interpolation.
        const float extinction =
            transfer.max_extinction(grid.value(static_cast<float>(low) - 1.0f),
                                    grid.value(static_cast<float>(high) + 1.0f));
        cells_.words[index(cx, cy, cz)] =
            extinction > 0 ? rounded_up(extinction * thinning.most(from, to)) : 0;
      }
    }
  });
  const Vec3 end = Vec3(last);
  for (int z = 0; z < cells_.count.z; ++z) {
    for (int y = 0; y < cells_.count.y; ++y) {
      for (int x = 0; x < cells_.count.x; ++x) {
        if (majorant(x, y, z) > 0) {
          occupied_.add(Vec3(x, y, z) * static_cast<float>(kCell));
          occupied_.add(glm::min(Vec3(x + 1, y + 1, z + 1) * static_cast<float>(kCell), end));
        }
      }
    }
  }
}

// Chessboard distances to the next cell with matter in two sweeps, each from all the neighbours
// that it has passed (Rosenfeld & Pfaltz 1966): those of the rows before, then the one in the row.
void MajorantGrid::find_distances() {
  constexpr std::uint8_t kFar = 255;
  const IVec3 count = cells_.count;
  const auto width = static_cast<size_t>(count.x);
  std::vector<std::uint8_t> distance(cells_.words.size());
  for (size_t i = 0; i < distance.size(); ++i) {
    distance[i] = cells_.words[i] != 0 ? 0 : kFar;
  }
  const auto one_more = [](std::uint8_t d) {
    return static_cast<std::uint8_t>(std::min<int>(d, kFar - 1) + 1);
  };
  std::vector<std::uint8_t> before(width + 2);  // the least of the rows before, with a border
  for (const int way : {1, -1}) {
    for (int i = 0; i < count.y * count.z; ++i) {
      const int row = way > 0 ? i : count.y * count.z - 1 - i;
      const int y = row % count.y;
      const int z = row / count.y;
      std::ranges::fill(before, kFar);
      for (const glm::ivec2 step : {glm::ivec2(-1, -1), {0, -1}, {1, -1}, {-1, 0}}) {
        const int other_y = y + way * step.x;
        const int other_z = z + way * step.y;
        if (other_y >= 0 && other_y < count.y && other_z >= 0 && other_z < count.z) {
          const std::uint8_t* const other = &distance[index(0, other_y, other_z)];
          for (size_t x = 0; x < width; ++x) {
            before[x + 1] = std::min(before[x + 1], other[x]);
          }
        }
      }
      std::uint8_t* const here = &distance[index(0, y, z)];
      for (size_t x = 0; x < width; ++x) {
        here[x] = std::min(here[x], one_more(std::min({before[x], before[x + 1], before[x + 2]})));
      }
      for (size_t k = 1; k < width; ++k) {
        const size_t x = way > 0 ? k : width - 1 - k;
        here[x] = std::min(here[x], one_more(here[way > 0 ? x - 1 : x + 1]));
      }
    }
  }
  for (size_t i = 0; i < distance.size(); ++i) {
    if (distance[i] > 0) {
      cells_.words[i] = rounded_up(distance[i]) | kMinus;
    }
  }
}

void MajorantGrid::find_matter(const VoxelGrid& grid, const TransferFunction& transfer,
                               const Thinning& thinning) {
  // "Is any code of [low, high] visible": yes if the next visible one at or above low is.
  constexpr int kCodes = 1 << 16;
  std::vector<int> next_visible(kCodes + 1, kCodes);
  for (int code = kCodes - 1; code >= 0; --code) {
    const auto value = static_cast<float>(code);
    const bool visible = transfer.max_extinction(grid.value(value - 1), grid.value(value + 1)) > 0;
    next_visible[static_cast<size_t>(code)] =
        visible ? code : next_visible[static_cast<size_t>(code) + 1];
  }
  const auto visible_between = [&](const IVec3& voxel) {
    std::uint16_t low = std::numeric_limits<std::uint16_t>::max();
    std::uint16_t high = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const std::uint16_t code =
          grid.code(voxel.x + (corner & 1), voxel.y + (corner >> 1 & 1), voxel.z + (corner >> 2));
      low = std::min(low, code);
      high = std::max(high, code);
    }
    return next_visible[low] <= high && thinning.most(voxel, voxel + 1) > 0;
  };
  parallel_for(static_cast<size_t>(cells_.count.z), 1, [&](size_t cz, size_t) {
    for (int cy = 0; cy < cells_.count.y; ++cy) {
      for (int cx = 0; cx < cells_.count.x; ++cx) {
        const IVec3 from = IVec3(cx, cy, static_cast<int>(cz)) * kCell;
        const IVec3 to = glm::min(from + kCell, grid.dims());
        const size_t cell = index(cx, cy, static_cast<int>(cz));
        if (cells_.words[cell] == 0) {
          continue;
        }
        for (int z = from.z; z < to.z; ++z) {
          for (int y = from.y; y < to.y; ++y) {
            for (int x = from.x; x < to.x; ++x) {
              if (visible_between({x, y, z})) {
                cells_.words[cell] |= 1U << matter_bit(x, y, z);
              }
            }
          }
        }
      }
    }
  });
}

}  // namespace clipgs
