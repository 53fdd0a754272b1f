#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/parallel.h"
#include "volume/volume.h"

namespace clipgs {

/// The least power of two, of steps of which 16 bits hold `range`: whole numbers stay whole.
inline float value_step(float range) {
  constexpr float kSteps = 65535;
  return std::exp2(std::ceil(std::log2(range / kSteps)));
}

/// Replaces the values of a volume, slice by slice: `fill(z, slice)` writes those of slice z, of
/// the values before, and may run on many threads. They are rounded to multiples of `step`
/// (value_step() keeps them in 16 bits; no more memory is taken than while a volume is loaded).
template <typename Fill>
void rewrite_values(Volume& volume, float step, const Fill& fill) {
  constexpr int kTogether = 16;  // slices
  const size_t slice = static_cast<size_t>(volume.dims.x) * volume.dims.y;
  std::vector<float> values(kTogether * slice);
  ValuePacker packer(volume.voxels());
  for (int first = 0; first < volume.dims.z; first += kTogether) {
    const auto count = static_cast<size_t>(std::min(kTogether, volume.dims.z - first));
    parallel_for(count, 1, [&](size_t i, size_t) {
      float* const out = &values[i * slice];
      fill(first + static_cast<int>(i), out);
      std::for_each_n(out, slice,
                      [step](float& value) { value = step * std::round(value / step); });
    });
    packer.append({values.data(), count * slice});
  }
  volume.values = packer.take();
}

}  // namespace clipgs
