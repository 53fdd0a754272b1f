#include "cinema/visible_matter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/parallel.h"

namespace clipgs {
namespace {

constexpr float kCell = 8;            // mean voxels: matter is grouped by cells of this side
constexpr float kLeastShare = 0.05f;  // of the largest extinction that counts as visible …
constexpr float kLeastMatterDepth =
    0.5f;                              // … or of optical depth across the volume's diagonal / 20
constexpr int kLeastVoxels = 6;        // in a cell, or it is a speck
constexpr double kLeastIsland = 0.01;  // share of all visible voxels that a group of cells needs

class VisibleVoxels {
 public:
  VisibleVoxels(const Volume& volume, const TransferFunction& transfer, const LabelLooks& labels,
                float least)
      : volume_(volume),
        transfer_(transfer),
        labels_(looks_of_labels(volume, labels)),
        least_(least) {}

  bool contains(size_t voxel) const {
    const Material& material = transfer_.at(volume_.values[voxel]);
    const float opacity = labels_.empty() ? 1.0f : labels_[volume_.labels[voxel]].opacity;
    return opacity * material.extinction >= least_;
  }

 private:
  const Volume& volume_;
  const TransferFunction& transfer_;
  std::vector<LabelLook> labels_;  // by the volume's indices; empty without labels
  float least_;                    // extinction, 1/mm
};

class CellGrid {
 public:
  CellGrid(const Volume& volume, const VisibleVoxels& visible)
      : cell_(glm::max(IVec3(1),
                       IVec3(glm::round(kCell * mean_spacing(volume.spacing) / volume.spacing)))),
        dims_((volume.dims + cell_ - 1) / cell_),
        counts_(static_cast<size_t>(dims_.x) * static_cast<size_t>(dims_.y) *
                static_cast<size_t>(dims_.z)) {
    const size_t slab = static_cast<size_t>(dims_.x) * static_cast<size_t>(dims_.y);
    parallel_for(static_cast<size_t>(dims_.z), 1, [&](size_t cz, size_t) {
      const int z_end = std::min(volume.dims.z, (static_cast<int>(cz) + 1) * cell_.z);
      for (int z = static_cast<int>(cz) * cell_.z; z < z_end; ++z) {
        for (int y = 0; y < volume.dims.y; ++y) {
          int* row = &counts_[cz * slab + static_cast<size_t>(y / cell_.y * dims_.x)];
          const size_t first = volume.offset(0, y, z);
          for (int x = 0; x < volume.dims.x; ++x) {
            row[x / cell_.x] += visible.contains(first + static_cast<size_t>(x)) ? 1 : 0;
          }
        }
      }
    });
  }

  // Groups of touching cells (26 neighbours) with enough matter; those that are too small are
  // emptied.
  void drop_islands() {
    std::vector<int> group(counts_.size(), -1);
    std::vector<double> sizes;
    double total = 0;
    std::vector<size_t> stack;
    for (size_t seed = 0; seed < counts_.size(); ++seed) {
      if (group[seed] >= 0 || counts_[seed] < kLeastVoxels) {
        continue;
      }
      const int name = static_cast<int>(sizes.size());
      sizes.push_back(0);
      group[seed] = name;
      stack.push_back(seed);
      while (!stack.empty()) {
        const size_t at = stack.back();
        stack.pop_back();
        sizes.back() += counts_[at];
        for_neighbours(at, [&](size_t beside) {
          if (group[beside] < 0 && counts_[beside] >= kLeastVoxels) {
            group[beside] = name;
            stack.push_back(beside);
          }
        });
      }
      total += sizes.back();
    }
    for (size_t i = 0; i < counts_.size(); ++i) {
      if (group[i] < 0 || sizes[static_cast<size_t>(group[i])] < kLeastIsland * total) {
        counts_[i] = 0;
      }
    }
  }

  bool has_matter(int x, int y, int z) const {
    return counts_[index(x / cell_.x, y / cell_.y, z / cell_.z)] > 0;
  }

 private:
  size_t index(int x, int y, int z) const {
    return (static_cast<size_t>(z) * static_cast<size_t>(dims_.y) + static_cast<size_t>(y)) *
               static_cast<size_t>(dims_.x) +
           static_cast<size_t>(x);
  }

  template <typename Visit>
  void for_neighbours(size_t at, const Visit& visit) const {
    const auto i = static_cast<int>(at);
    const IVec3 cell(i % dims_.x, i / dims_.x % dims_.y, i / (dims_.x * dims_.y));
    const IVec3 first = glm::max(cell - 1, IVec3(0));
    const IVec3 last = glm::min(cell + 1, dims_ - 1);
    for (int z = first.z; z <= last.z; ++z) {
      for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
          const size_t beside = index(x, y, z);
          if (beside != at) {
            visit(beside);
          }
        }
      }
    }
  }

  IVec3 cell_;  // voxels along the axes: as near to a cube as they can be
  IVec3 dims_;
  std::vector<int> counts_;  // visible voxels of each cell
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

VisibleMatter visible_matter(const Volume& volume, const TransferFunction& transfer,
                             const LabelLooks& labels) {
  const float diagonal = glm::length(volume.bounds().size());
  const float most = transfer.max_extinction(std::numeric_limits<float>::lowest(),
                                             std::numeric_limits<float>::max());
  const float least =
      std::min(kLeastShare * most, kLeastMatterDepth * 20.0f / std::max(diagonal, 1e-6f));
  VisibleMatter matter;
  if (least > 0) {
    const VisibleVoxels voxels(volume, transfer, labels, least);
    CellGrid cells(volume, voxels);
    cells.drop_islands();
    // The ends of every row of voxels span all that lies between.
    const auto visible = [&](int x, int y, int z) {
      return cells.has_matter(x, y, z) && voxels.contains(volume.offset(x, y, z));
    };
    std::vector<std::vector<Vec3>> slices(static_cast<size_t>(volume.dims.z));
    parallel_for(slices.size(), 1, [&](size_t slice, size_t) {
      const int z = static_cast<int>(slice);
      for (int y = 0; y < volume.dims.y; ++y) {
        int first = 0;
        int last = volume.dims.x - 1;
        while (first <= last && !visible(first, y, z)) {
          ++first;
        }
        while (last > first && !visible(last, y, z)) {
          --last;
        }
        if (first <= last) {
          for (const int x : {first, last}) {
            slices[slice].push_back(volume.world_from_index(Vec3(x, y, z)));
          }
        }
      }
    });
    for (const std::vector<Vec3>& points : slices) {
      for (const Vec3& point : points) {
        matter.hull.push_back(point);
        matter.bounds.add(point);
      }
    }
  }
  if (matter.hull.empty()) {
    throw Error(
        "nothing of the volume is visible with this preset{}; choose another with --preset, or "
        "check the values with 'clipgs info' (8-bit data may need --hu scale,offset)",
        volume.labels.empty() ? "" : " and these labels");
  }
  matter.sphere = enclosing_sphere(matter.hull, matter.bounds.center());
  return matter;
}

}  // namespace clipgs
