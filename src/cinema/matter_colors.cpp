#include "cinema/matter_colors.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace clipgs {
namespace {

enum Kind : std::uint8_t { kEmpty, kMixed, kPure };

/// Calls visit(offset) for the neighbours of a voxel, by faces, edges and corners.
template <typename Visit>
void for_neighbours(const Volume& volume, const IVec3& at, const Visit& visit) {
  const IVec3 first = glm::max(at - 1, IVec3(0));
  const IVec3 last = glm::min(at + 1, volume.dims - 1);
  for (int z = first.z; z <= last.z; ++z) {
    for (int y = first.y; y <= last.y; ++y) {
      for (int x = first.x; x <= last.x; ++x) {
        if (IVec3(x, y, z) != at) {
          visit(volume.offset(x, y, z));
        }
      }
    }
  }
}

/// Calls visit(at, offset) for every voxel, slice by slice on many threads.
template <typename Visit>
void for_voxels(const Volume& volume, const Visit& visit) {
  parallel_for(static_cast<size_t>(volume.dims.z), 1, [&](size_t z, size_t) {
    for (int y = 0; y < volume.dims.y; ++y) {
      for (int x = 0; x < volume.dims.x; ++x) {
        const IVec3 at(x, y, static_cast<int>(z));
        visit(at, volume.offset(at.x, at.y, at.z));
      }
    }
  });
}

std::vector<std::uint8_t> kinds_of(const Volume& volume, const TransferFunction& transfer) {
  std::vector<std::uint8_t> kinds(volume.voxels());
  for_voxels(volume, [&](const IVec3&, size_t voxel) {
    kinds[voxel] = transfer.at(volume.values[voxel]).extinction > 0 ? kPure : kEmpty;
  });
  std::vector<std::uint8_t> result = kinds;
  for_voxels(volume, [&](const IVec3& at, size_t voxel) {
    if (kinds[voxel] == kPure) {
      for_neighbours(volume, at, [&](size_t beside) {
        result[voxel] = kinds[beside] == kEmpty ? std::uint8_t{kMixed} : result[voxel];
      });
    }
  });
  return result;
}

float brightness(const Vec3& color) { return color.r + color.g + color.b; }

}  // namespace

std::vector<std::uint8_t> matter_colors(const Volume& volume, const TransferFunction& transfer) {
  std::vector<std::uint8_t> colors = volume.rgb;
  if (colors.empty()) {
    return colors;
  }
  std::vector<std::uint8_t> kinds = kinds_of(volume, transfer);
  const auto color_of = [](const std::vector<std::uint8_t>& from, size_t voxel) {
    return Vec3(from[3 * voxel], from[3 * voxel + 1], from[3 * voxel + 2]);
  };
  // Inside out: a soft edge has two layers of mixed voxels, then come the empty ones.
  for (const Kind kind : {kMixed, kMixed, kEmpty}) {
    const std::vector<std::uint8_t> old = colors;
    const std::vector<std::uint8_t> were = kinds;
    for_voxels(volume, [&](const IVec3& at, size_t voxel) {
      if (were[voxel] != kind) {
        return;
      }
      Vec3 sum(0);
      float count = 0;
      for_neighbours(volume, at, [&](size_t beside) {
        if (were[beside] > kind) {
          sum += color_of(old, beside);
          count += 1;
        }
      });
      if (count == 0) {
        return;
      }
      kinds[voxel] = kind == kMixed ? kPure : kEmpty;
      const Vec3 mean = sum / count;
      if (brightness(mean) > brightness(color_of(old, voxel))) {
        for (int c = 0; c < 3; ++c) {
          colors[3 * voxel + static_cast<size_t>(c)] =
              static_cast<std::uint8_t>(std::lround(mean[c]));
        }
      }
    });
  }
  return colors;
}

}  // namespace clipgs
