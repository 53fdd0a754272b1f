#include "volume/smooth_within.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "volume/rewrite_values.h"

namespace clipgs {
namespace {

constexpr int kMostPasses = 32;  // along an axis

std::vector<size_t> places_of(const BitMask& mask) {
  std::vector<size_t> places;
  places.reserve(mask.count());
  for (size_t i = mask.next(0); i < mask.size(); i = mask.next(i + 1)) {
    places.push_back(i);
  }
  return places;
}

/// What lies to either side of a place along an axis: one of the places, or a value that stays.
struct Beside {
  std::ptrdiff_t slot = -1;
  float value = 0;

  float of(const std::vector<float>& values) const {
    return slot < 0 ? value : values[static_cast<size_t>(slot)];
  }
};
using Neighbours = std::vector<std::array<Beside, 2>>;

Neighbours neighbours_along(const Volume& volume, const std::vector<size_t>& places, int axis) {
  const IVec3 dims = volume.dims;
  const std::array<size_t, 3> strides = {1, static_cast<size_t>(dims.x),
                                         static_cast<size_t>(dims.x) * dims.y};
  const size_t stride = strides[static_cast<size_t>(axis)];
  Neighbours neighbours(places.size());
  parallel_for(places.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      const auto along = static_cast<int>(places[k] / stride % static_cast<size_t>(dims[axis]));
      for (const int step : {-1, 1}) {
        Beside& beside = neighbours[k][step < 0 ? 0 : 1];
        if (along + step < 0 || along + step >= dims[axis]) {
          beside.slot = static_cast<std::ptrdiff_t>(k);  // beyond the end it goes on alike
          continue;
        }
        const size_t there = step < 0 ? places[k] - stride : places[k] + stride;
        const auto found = std::ranges::lower_bound(places, there);
        if (found != places.end() && *found == there) {
          beside.slot = found - places.begin();
        } else {
          beside.value = volume.values[there];
        }
      }
    }
  });
  return neighbours;
}

}  // namespace

void smooth_within(Volume& volume, const BitMask& mask, float deviation) {
  const std::vector<size_t> places = places_of(mask);
  if (places.empty()) {
    return;
  }
  std::vector<float> values(places.size());
  std::ranges::transform(places, values.begin(), [&](size_t at) { return volume.values[at]; });
  for (int axis = 0; axis < 3; ++axis) {
    // A pass of weights w, 1 − 2w, w has the variance 2w, of which at most ½ does not ring.
    const float wanted = std::pow(deviation / volume.spacing[axis], 2.0f);
    const int passes = std::clamp(static_cast<int>(std::ceil(2 * wanted)), 1, kMostPasses);
    const float w = std::min(0.25f, 0.5f * wanted / static_cast<float>(passes));
    const Neighbours neighbours = neighbours_along(volume, places, axis);
    for (int pass = 0; pass < passes; ++pass) {
      std::vector<float> next(values.size());
      parallel_for(values.size(), size_t{1} << 16, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
          const auto& [before, after] = neighbours[k];
          next[k] = (1 - 2 * w) * values[k] + w * (before.of(values) + after.of(values));
        }
      });
      values = std::move(next);
    }
  }
  const auto [least, most] = volume.values.range();
  const float step = value_step(most - least);
  std::ranges::transform(values, values.begin(),
                         [step](float value) { return step * std::round(value / step); });
  volume.values.set(places, values);
}

}  // namespace clipgs
