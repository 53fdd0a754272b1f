#include "volume/spline_field.h"

#include <algorithm>
#include <cstddef>
#include <functional>

namespace clipgs {

SplineField::SplineField(int elements)
    : elements_(elements),
      points_(elements + 3),
      values_(static_cast<size_t>(points_) * points_ * points_, 0.0f) {}

SplineField::Support SplineField::support(float place) const {
  const float at = std::clamp(place, 0.0f, 1.0f) * static_cast<float>(elements_);
  const int first = std::min(static_cast<int>(at), elements_ - 1);
  const float t = at - static_cast<float>(first);
  const float s = 1 - t;
  return {first,
          {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6,
           t * t * t / 6}};
}

void SplineField::add(const SplineField& other) {
  std::ranges::transform(values_, other.values_, values_.begin(), std::plus());
}

void SplineField::evaluate_row(const std::vector<Support>& along_x, const Support& y,
                               const Support& z, float* row) const {
  std::vector<float> line(points_, 0.0f);
  for (int k = 0; k < 4; ++k) {
    for (int j = 0; j < 4; ++j) {
      const float weight = z.weights[k] * y.weights[j];
      for (int x = 0; x < points_; ++x) {
        line[x] += weight * at(x, y.first + j, z.first + k);
      }
    }
  }
  for (size_t i = 0; i < along_x.size(); ++i) {
    const Support& x = along_x[i];
    row[i] = x.weights[0] * line[x.first] + x.weights[1] * line[x.first + 1] +
             x.weights[2] * line[x.first + 2] + x.weights[3] * line[x.first + 3];
  }
}

std::vector<SplineField::Support> supports(const SplineField& field, int count) {
  std::vector<SplineField::Support> list;
  list.reserve(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) {
    list.push_back(
        field.support(static_cast<float>(i) / static_cast<float>(std::max(count - 1, 1))));
  }
  return list;
}

SplineField approximate(const IVec3& dims, const std::vector<float>& values,
                        const std::vector<unsigned char>& inside, int elements) {
  SplineField field(elements);
  SplineField weights(elements);
  const auto along_x = supports(field, dims.x);
  const auto along_y = supports(field, dims.y);
  const auto along_z = supports(field, dims.z);
  // The sum of the squared weights of a place is a product over the axes.
  const auto squares = [](const SplineField::Support& s) {
    float sum = 0;
    for (const float w : s.weights) {
      sum += w * w;
    }
    return sum;
  };
  for (int z = 0; z < dims.z; ++z) {
    for (int y = 0; y < dims.y; ++y) {
      const float plane = squares(along_z[z]) * squares(along_y[y]);
      for (int x = 0; x < dims.x; ++x) {
        const size_t at = (static_cast<size_t>(z) * dims.y + y) * dims.x + x;
        if (inside[at] == 0) {
          continue;
        }
        const float share = values[at] / (plane * squares(along_x[x]));
        for (int n = 0; n < 64; ++n) {
          const int i = n % 4;
          const int j = n / 4 % 4;
          const int k = n / 16;
          const float w = along_x[x].weights[i] * along_y[y].weights[j] * along_z[z].weights[k];
          const IVec3 to(along_x[x].first + i, along_y[y].first + j, along_z[z].first + k);
          field.at(to.x, to.y, to.z) += w * w * w * share;
          weights.at(to.x, to.y, to.z) += w * w;
        }
      }
    }
  }
  for (int z = 0; z < field.points(); ++z) {
    for (int y = 0; y < field.points(); ++y) {
      for (int x = 0; x < field.points(); ++x) {
        const float weight = weights.at(x, y, z);
        field.at(x, y, z) = weight > 0 ? field.at(x, y, z) / weight : 0.0f;
      }
    }
  }
  return field;
}

}  // namespace clipgs
