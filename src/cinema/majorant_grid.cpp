#include "cinema/majorant_grid.h"

#include "core/parallel.h"

namespace clipgs {

MajorantGrid::MajorantGrid(const VoxelGrid& grid, const TransferFunction& transfer) {
  cells_ = glm::max((grid.dims() - 1 + (kCell - 1)) / kCell, IVec3(1));
  stride_ = {1, cells_.x + 2, static_cast<std::ptrdiff_t>(cells_.x + 2) * (cells_.y + 2)};
  majorants_.assign(static_cast<size_t>(stride_[2]) * static_cast<size_t>(cells_.z + 2), 0.0f);
  find_majorants(grid, transfer);
  find_leaps();
  find_mask(grid, transfer);
}

void MajorantGrid::find_majorants(const VoxelGrid& grid, const TransferFunction& transfer) {
  const IVec3 last = grid.dims() - 1;
  parallel_for(static_cast<size_t>(cells_.z), 1, [&](size_t begin, size_t) {
    const int cz = static_cast<int>(begin);
    for (int cy = 0; cy < cells_.y; ++cy) {
      for (int cx = 0; cx < cells_.x; ++cx) {
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
        majorants_[static_cast<size_t>((cx + 1) + (cy + 1) * stride_[1] + (cz + 1) * stride_[2])] =
            transfer.max_extinction(grid.value(static_cast<float>(low) - 1.0f),
                                    grid.value(static_cast<float>(high) + 1.0f));
      }
    }
  });
  const Vec3 end = Vec3(last);
  for (int z = 0; z < cells_.z; ++z) {
    for (int y = 0; y < cells_.y; ++y) {
      for (int x = 0; x < cells_.x; ++x) {
        if (majorant(x, y, z) > 0) {
          occupied_.add(Vec3(x, y, z) * static_cast<float>(kCell));
          occupied_.add(glm::min(Vec3(x + 1, y + 1, z + 1) * static_cast<float>(kCell), end));
        }
      }
    }
  }
}

void MajorantGrid::find_leaps() {
  constexpr int kFar = 255;
  leaps_.assign(majorants_.size() * 8, kFar);  // outside there is nothing, for ever
  parallel_for(8, 1, [&](size_t octant, size_t) {
    std::uint8_t* const leap = leaps_.data() + octant * majorants_.size();
    IVec3 first;
    std::array<std::ptrdiff_t, 3> ahead;
    for (int k = 0; k < 3; ++k) {
      const bool negative = ((octant >> k) & 1U) != 0;
      // From the far end backwards, so that the cells ahead are known.
      first[k] = negative ? 1 : cells_[k];
      ahead[k] = negative ? -stride_[k] : stride_[k];
    }
    for (int z = 0; z < cells_.z; ++z) {
      for (int y = 0; y < cells_.y; ++y) {
        for (int x = 0; x < cells_.x; ++x) {
          const std::ptrdiff_t cell = first.x * stride_[0] + first.y * stride_[1] +
                                      first.z * stride_[2] - x * ahead[0] - y * ahead[1] -
                                      z * ahead[2];
          if (majorants_[static_cast<size_t>(cell)] > 0) {
            leap[cell] = 0;
            continue;
          }
          int free = kFar - 1;
          for (int corner = 1; corner < 8; ++corner) {
            const std::ptrdiff_t neighbour = cell + ((corner & 1) != 0 ? ahead[0] : 0) +
                                             ((corner & 2) != 0 ? ahead[1] : 0) +
                                             ((corner & 4) != 0 ? ahead[2] : 0);
            free = std::min<int>(free, leap[neighbour]);
          }
          leap[cell] = static_cast<std::uint8_t>(free + 1);
        }
      }
    }
  });
}

void MajorantGrid::find_mask(const VoxelGrid& grid, const TransferFunction& transfer) {
  const IVec3 dims = grid.dims();
  mask_stride_y_ = static_cast<std::ptrdiff_t>((dims.x + 63) / 64) * 64;
  mask_stride_z_ = mask_stride_y_ * dims.y;
  mask_.assign(static_cast<size_t>(mask_stride_z_ * dims.z / 64), 0);
  // "Is any code of [low, high] visible": yes if the next visible one at or above low is.
  constexpr int kCodes = 1 << 16;
  std::vector<int> next_visible(kCodes + 1, kCodes);
  for (int code = kCodes - 1; code >= 0; --code) {
    const auto value = static_cast<float>(code);
    const bool visible = transfer.max_extinction(grid.value(value - 1), grid.value(value + 1)) > 0;
    next_visible[static_cast<size_t>(code)] =
        visible ? code : next_visible[static_cast<size_t>(code) + 1];
  }
  parallel_for(static_cast<size_t>(dims.z), 1, [&](size_t begin, size_t) {
    const int z = static_cast<int>(begin);
    for (int y = 0; y < dims.y; ++y) {
      for (int x = 0; x < dims.x; ++x) {
        const IVec3 cell = glm::min(IVec3(x, y, z) / kCell, cells_ - 1);
        if (!(majorant(cell.x, cell.y, cell.z) > 0)) {
          x = std::max(x, (cell.x + 1) * kCell - 1);
          continue;
        }
        std::uint16_t low = std::numeric_limits<std::uint16_t>::max();
        std::uint16_t high = 0;
        for (int corner = 0; corner < 8; ++corner) {
          const std::uint16_t code =
              grid.code(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2));
          low = std::min(low, code);
          high = std::max(high, code);
        }
        if (next_visible[low] <= high) {
          const std::ptrdiff_t bit = z * mask_stride_z_ + y * mask_stride_y_ + x;
          mask_[static_cast<size_t>(bit >> 6)] |= std::uint64_t{1} << (bit & 63);
        }
      }
    }
  });
}

}  // namespace clipgs
