#include "asset/palette.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace clipgs {

namespace {

constexpr size_t kLanes = 8;
constexpr size_t kMaxDimension = 48;
constexpr size_t kPaletteGrain = 512;
constexpr int kCoarseIterations = 5;
constexpr int kFineIterations = 5;
constexpr size_t kProbes = 6;  // nearest cells that a point looks through

/// Vectors padded with zeros to a multiple of kLanes, so that the compiler can use SIMD without
/// changing the order of the additions.
struct Vectors {
  size_t stride = 0;
  std::vector<float> data;

  Vectors(size_t count, size_t dimension)
      : stride((dimension + kLanes - 1) / kLanes * kLanes), data(count * stride, 0.0f) {}
  size_t size() const { return data.size() / stride; }
  float* operator[](size_t i) { return data.data() + i * stride; }
  const float* operator[](size_t i) const { return data.data() + i * stride; }
};

float squared_distance(const float* a, const float* b, size_t stride) {
  std::array<float, kLanes> sums{};
  for (size_t d = 0; d < stride; d += kLanes) {
    for (size_t lane = 0; lane < kLanes; ++lane) {
      const float difference = a[d + lane] - b[d + lane];
      sums[lane] += difference * difference;
    }
  }
  return ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
}

struct Nearest {
  size_t index = 0;
  float distance = std::numeric_limits<float>::max();
};

/// Looks through centroids [begin, end).
void search(const float* point, const Vectors& centroids, size_t begin, size_t end,
            Nearest& nearest) {
  for (size_t c = begin; c < end; ++c) {
    const float distance = squared_distance(point, centroids[c], centroids.stride);
    if (distance < nearest.distance) {
      nearest = {c, distance};
    }
  }
}

/// The members of each group in ascending order: group g owns members[starts[g]…starts[g+1]).
struct Groups {
  std::vector<size_t> starts;
  std::vector<size_t> members;

  Groups(const std::vector<Nearest>& nearest, size_t count)
      : starts(count + 1, 0), members(nearest.size()) {
    for (const Nearest& n : nearest) {
      ++starts[n.index + 1];
    }
    for (size_t g = 0; g < count; ++g) {
      starts[g + 1] += starts[g];
    }
    std::vector<size_t> next(starts.begin(), starts.end() - 1);
    for (size_t i = 0; i < nearest.size(); ++i) {
      members[next[nearest[i].index]++] = i;
    }
  }
  size_t size(size_t g) const { return starts[g + 1] - starts[g]; }
};

/// Moves each centroid to the weighted mean of its points; one without points stays.
void move_centroids(const Vectors& points, const std::vector<float>& weights, const Groups& groups,
                    Vectors& centroids) {
  parallel_for(centroids.size(), 16, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c) {
      if (groups.size(c) == 0) {
        continue;
      }
      std::array<double, kMaxDimension> sum{};
      double total = 0;
      for (size_t m = groups.starts[c]; m < groups.starts[c + 1]; ++m) {
        const size_t i = groups.members[m];
        const double weight = weights[i];
        total += weight;
        for (size_t d = 0; d < points.stride; ++d) {
          sum[d] += weight * points[i][d];
        }
      }
      for (size_t d = 0; d < points.stride; ++d) {
        centroids[c][d] = static_cast<float>(sum[d] / total);
      }
    }
  });
}

/// Coarse cells and, of each, a contiguous range of fine centroids.
struct Tree {
  Vectors cells;
  Vectors centroids;
  std::vector<size_t> starts;  // of each cell's centroids, and the end

  std::vector<Nearest> assign(const Vectors& points) const {
    std::vector<Nearest> nearest(points.size());
    parallel_for(points.size(), kPaletteGrain, [&](size_t begin, size_t end) {
      std::vector<Nearest> order(cells.size());
      const size_t probes = std::min(kProbes, cells.size());
      for (size_t i = begin; i < end; ++i) {
        for (size_t c = 0; c < cells.size(); ++c) {
          order[c] = {c, squared_distance(points[i], cells[c], cells.stride)};
        }
        std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(probes),
                          order.end(), [](const Nearest& a, const Nearest& b) {
                            return a.distance < b.distance ||
                                   (a.distance == b.distance && a.index < b.index);
                          });
        for (size_t p = 0; p < probes; ++p) {
          const size_t cell = order[p].index;
          search(points[i], centroids, starts[cell], starts[cell + 1], nearest[i]);
        }
      }
    });
    return nearest;
  }
};

/// `count` vectors drawn evenly from members [begin, end) of `points`.
void draw_evenly(const Vectors& points, const size_t* members, size_t member_count, size_t count,
                 float* to) {
  for (size_t k = 0; k < count; ++k) {
    const float* from = points[members[k * member_count / count]];
    std::copy(from, from + points.stride, to + k * points.stride);
  }
}

Tree plant(const Vectors& points, const std::vector<float>& weights, size_t dimension,
           size_t size) {
  const auto cell_count = static_cast<size_t>(std::ceil(std::sqrt(static_cast<double>(size))));
  Tree tree{Vectors(cell_count, dimension), Vectors(size, dimension), {0}};
  std::vector<size_t> all(points.size());
  for (size_t i = 0; i < all.size(); ++i) {
    all[i] = i;
  }
  draw_evenly(points, all.data(), all.size(), cell_count, tree.cells.data.data());

  std::vector<Nearest> nearest(points.size());
  const auto assign = [&] {
    parallel_for(points.size(), kPaletteGrain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        nearest[i] = {};
        search(points[i], tree.cells, 0, cell_count, nearest[i]);
      }
    });
  };
  for (int iteration = 0; iteration < kCoarseIterations; ++iteration) {
    assign();
    move_centroids(points, weights, Groups(nearest, cell_count), tree.cells);
  }
  assign();

  // With d dimensions the error of a cell falls as k^(−2/d), nearly not at all: the best shares are
  // close to proportional to the cells' errors.
  const Groups groups(nearest, cell_count);
  std::vector<double> errors(cell_count, 0);
  double total = 0;
  for (size_t i = 0; i < nearest.size(); ++i) {
    const double error = double{weights[i]} * nearest[i].distance;
    errors[nearest[i].index] += error;
    total += error;
  }
  for (size_t c = 0; c < cell_count; ++c) {
    const double share = total > 0 ? errors[c] / total : 0;
    const size_t wanted = 1 + static_cast<size_t>(share * static_cast<double>(size - cell_count));
    const size_t count = std::min(wanted, groups.size(c));
    draw_evenly(points, groups.members.data() + groups.starts[c], groups.size(c), count,
                tree.centroids[tree.starts.back()]);
    tree.starts.push_back(tree.starts.back() + count);
  }
  tree.centroids.data.resize(tree.starts.back() * tree.centroids.stride);
  return tree;
}

}  // namespace

Palette fit_palette(const std::vector<float>& points, const std::vector<float>& weights,
                    size_t dimension, size_t size) {
  const size_t count = points.size() / dimension;
  Vectors padded(count, dimension);
  for (size_t i = 0; i < count; ++i) {
    std::copy_n(points.begin() + static_cast<std::ptrdiff_t>(i * dimension), dimension, padded[i]);
  }
  Tree tree = plant(padded, weights, dimension, std::min({size, count, kMaxPaletteSize}));
  std::vector<Nearest> nearest = tree.assign(padded);
  for (int iteration = 0; iteration < kFineIterations; ++iteration) {
    move_centroids(padded, weights, Groups(nearest, tree.centroids.size()), tree.centroids);
    nearest = tree.assign(padded);
  }

  Palette palette;
  palette.dimension = dimension;
  for (size_t c = 0; c < tree.centroids.size(); ++c) {
    const float* centroid = tree.centroids[c];
    palette.centroids.insert(palette.centroids.end(), centroid, centroid + dimension);
  }
  for (const Nearest& n : nearest) {
    palette.labels.push_back(static_cast<std::uint16_t>(n.index));
  }
  return palette;
}

}  // namespace clipgs
