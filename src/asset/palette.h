#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace clipgs {

/// A vector quantiser: `labels[i]` names the centroid that stands for point i.
struct Palette {
  size_t dimension = 0;
  std::vector<float> centroids;       ///< [size(), dimension]
  std::vector<std::uint16_t> labels;  ///< one a point

  size_t size() const { return dimension == 0 ? 0 : centroids.size() / dimension; }
};

constexpr size_t kMaxPaletteSize = 65536;

/// At most `size` centroids for `points` [n, dimension] by k-means, in which the squared error of
/// point i counts `weights[i]` > 0 times. Fast: a coarse k-means of about √size cells first, which
/// share the centroids out by their error, then Lloyd iterations in which a point looks only
/// through the centroids of its nearest cells. Starts are drawn evenly from the points in their
/// order, nothing is random, and the thread count changes nothing.
Palette fit_palette(const std::vector<float>& points, const std::vector<float>& weights,
                    size_t dimension, size_t size);

}  // namespace clipgs
