#include "cinema/visible_matter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/parallel.h"

namespace clipgs {
namespace {

constexpr int kCell = 8;               // voxels: matter is grouped by cells
constexpr float kLeastShare = 0.05f;   // of the largest extinction that counts as visible …
constexpr float kLeastDepth = 0.5f;    // … or of optical depth across the volume's diagonal / 20
constexpr int kLeastVoxels = 6;        // in a cell, or it is a speck
constexpr double kLeastIsland = 0.01;  // share of all visible voxels that a group of cells needs

struct Cell {
  int count = 0;
  IVec3 min{std::numeric_limits<int>::max()};
  IVec3 max{-1};
};

class CellGrid {
 public:
  CellGrid(const Volume& volume, const TransferFunction& transfer, float least)
      : dims_((volume.dims + kCell - 1) / kCell),
        cells_(static_cast<size_t>(dims_.x) * static_cast<size_t>(dims_.y) *
               static_cast<size_t>(dims_.z)) {
    const size_t slab = static_cast<size_t>(dims_.x) * static_cast<size_t>(dims_.y);
    parallel_for(static_cast<size_t>(dims_.z), 1, [&](size_t cz, size_t) {
      const int z_end = std::min(volume.dims.z, (static_cast<int>(cz) + 1) * kCell);
      for (int z = static_cast<int>(cz) * kCell; z < z_end; ++z) {
        for (int y = 0; y < volume.dims.y; ++y) {
          Cell* row = &cells_[cz * slab + static_cast<size_t>(y / kCell * dims_.x)];
          const float* values = &volume.values[volume.offset(0, y, z)];
          for (int x = 0; x < volume.dims.x; ++x) {
            if (transfer.at(values[x]).extinction >= least) {
              Cell& cell = row[x / kCell];
              ++cell.count;
              cell.min = glm::min(cell.min, IVec3(x, y, z));
              cell.max = glm::max(cell.max, IVec3(x, y, z));
            }
          }
        }
      }
    });
  }

  // Groups of touching cells (26 neighbours) with enough matter; those that are too small are
  // emptied.
  void drop_islands() {
    std::vector<int> group(cells_.size(), -1);
    std::vector<double> sizes;
    double total = 0;
    std::vector<size_t> stack;
    for (size_t seed = 0; seed < cells_.size(); ++seed) {
      if (group[seed] >= 0 || cells_[seed].count < kLeastVoxels) {
        continue;
      }
      const int name = static_cast<int>(sizes.size());
      sizes.push_back(0);
      group[seed] = name;
      stack.push_back(seed);
      while (!stack.empty()) {
        const size_t at = stack.back();
        stack.pop_back();
        sizes.back() += cells_[at].count;
        for_neighbours(at, [&](size_t beside) {
          if (group[beside] < 0 && cells_[beside].count >= kLeastVoxels) {
            group[beside] = name;
            stack.push_back(beside);
          }
        });
      }
      total += sizes.back();
    }
    for (size_t i = 0; i < cells_.size(); ++i) {
      if (group[i] < 0 || sizes[static_cast<size_t>(group[i])] < kLeastIsland * total) {
        cells_[i] = Cell();
      }
    }
  }

  // Calls visit(cell, inside): inside if all its neighbours hold matter too.
  template <typename Visit>
  void for_matter(const Visit& visit) const {
    for (size_t i = 0; i < cells_.size(); ++i) {
      if (cells_[i].count > 0) {
        int full = 0;
        for_neighbours(i, [&](size_t beside) { full += cells_[beside].count > 0 ? 1 : 0; });
        visit(cells_[i], full == 26);
      }
    }
  }

 private:
  template <typename Visit>
  void for_neighbours(size_t at, const Visit& visit) const {
    const auto i = static_cast<int>(at);
    const IVec3 cell(i % dims_.x, i / dims_.x % dims_.y, i / (dims_.x * dims_.y));
    const IVec3 first = glm::max(cell - 1, IVec3(0));
    const IVec3 last = glm::min(cell + 1, dims_ - 1);
    for (int z = first.z; z <= last.z; ++z) {
      for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
          const auto beside = static_cast<size_t>((z * dims_.y + y) * dims_.x + x);
          if (beside != at) {
            visit(beside);
          }
        }
      }
    }
  }

  IVec3 dims_;
  std::vector<Cell> cells_;
};

// Smallest enclosing sphere, to a fraction of a percent (Bădoiu & Clarkson 2003): the centre steps
// towards the farthest point, ever less.
Sphere enclosing_sphere(const std::vector<Vec3>& points, const Vec3& start) {
  Sphere sphere{start, 0};
  constexpr int kSteps = 200;
  for (int i = 1; i <= kSteps + 1; ++i) {
    float farthest = -1;
    Vec3 point(0);
    for (const Vec3& p : points) {
      const Vec3 offset = p - sphere.center;
      const float distance2 = glm::dot(offset, offset);
      if (distance2 > farthest) {
        farthest = distance2;
        point = p;
      }
    }
    sphere.radius = std::sqrt(farthest);
    if (i <= kSteps) {
      sphere.center += (point - sphere.center) / static_cast<float>(i + 1);
    }
  }
  return sphere;
}

}  // namespace

Vec2 VisibleMatter::extent(const Vec3& normal) const {
  Vec2 interval(std::numeric_limits<float>::max(), std::numeric_limits<float>::lowest());
  for (const Vec3& point : hull) {
    const float height = glm::dot(normal, point);
    interval = {std::min(interval.x, height), std::max(interval.y, height)};
  }
  return interval;
}

VisibleMatter visible_matter(const Volume& volume, const TransferFunction& transfer) {
  const float diagonal = glm::length(volume.bounds().size());
  const float most = transfer.max_extinction(std::numeric_limits<float>::lowest(),
                                             std::numeric_limits<float>::max());
  const float least = std::min(kLeastShare * most, kLeastDepth * 20.0f / std::max(diagonal, 1e-6f));
  VisibleMatter matter;
  if (least > 0) {
    CellGrid cells(volume, transfer, least);
    cells.drop_islands();
    cells.for_matter([&](const Cell& cell, bool inside) {
      if (inside) {
        return;
      }
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3 index((corner & 1) != 0 ? cell.max.x : cell.min.x,
                         (corner & 2) != 0 ? cell.max.y : cell.min.y,
                         (corner & 4) != 0 ? cell.max.z : cell.min.z);
        matter.hull.push_back(volume.world_from_index(index));
        matter.bounds.add(matter.hull.back());
      }
    });
  }
  if (matter.hull.empty()) {
    throw Error(
        "nothing of the volume is visible with this preset; choose another with --preset, or check "
        "the values with 'clipgs info' (8-bit data may need --hu scale,offset)");
  }
  matter.sphere = enclosing_sphere(matter.hull, matter.bounds.center());
  return matter;
}

}  // namespace clipgs
