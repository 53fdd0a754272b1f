#pragma once

#include <array>
#include <vector>

#include "core/geometry.h"

namespace clipgs {

/// A smooth function over a box, a uniform cubic B-spline with `elements` pieces along each axis.
/// Places are 0…1 along the axes.
class SplineField {
 public:
  explicit SplineField(int elements);

  /// The four control points along an axis that a place depends on, and their weights.
  struct Support {
    int first = 0;
    std::array<float, 4> weights{};
  };
  Support support(float place) const;

  int points() const { return points_; }  ///< control points along each axis
  float& at(int x, int y, int z) { return values_[index(x, y, z)]; }
  float at(int x, int y, int z) const { return values_[index(x, y, z)]; }

  /// Adds a field of as many elements.
  void add(const SplineField& other);
  /// What the field is along a row of places that share two of the coordinates.
  void evaluate_row(const std::vector<Support>& along_x, const Support& y, const Support& z,
                    float* row) const;

 private:
  size_t index(int x, int y, int z) const {
    return (static_cast<size_t>(z) * points_ + y) * points_ + x;
  }

  int elements_;
  int points_;
  std::vector<float> values_;
};

/// The supports of `count` places spread from 0 to 1.
std::vector<SplineField::Support> supports(const SplineField& field, int count);

/// A field near `values` [dims.z, dims.y, dims.x] where `inside` is not 0, and 0 far from there
/// (Lee, Wolberg and Shin, IEEE TVCG 3, 1997, algorithm BA). One step comes near, no more: what is
/// left is to be approximated again.
SplineField approximate(const IVec3& dims, const std::vector<float>& values,
                        const std::vector<unsigned char>& inside, int elements);

}  // namespace clipgs
