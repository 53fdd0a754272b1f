#include "train/adam.h"

#include <algorithm>

#include "core/parallel.h"

namespace clipgs {

namespace {

float rate_of(int plane, const Gaussians& gaussians, const LearningRates& rates) {
  if (plane < Gaussians::kLogScale) {
    return rates.mean;
  }
  if (plane < Gaussians::kRotation) {
    return rates.log_scale;
  }
  if (plane < Gaussians::kOpacity) {
    return rates.rotation;
  }
  if (plane < Gaussians::kSh) {
    return rates.opacity;
  }
  if (plane >= gaussians.face()) {
    return rates.face;
  }
  return plane < Gaussians::kSh + 3 ? rates.sh0 : rates.sh_rest;
}

}  // namespace

void Adam::step(const std::vector<std::uint32_t>& reached, const Gaussians& gradients,
                const LearningRates& rates, Gaussians& gaussians) {
  // In index order memory is walked forwards; a mask keeps the inner loop free of gathers.
  const size_t size = gaussians.size();
  std::vector<float> corrections(size, 0.0f);  // 0: not reached
  for (const std::uint32_t i : reached) {
    corrections[i] = Adam::correction(static_cast<float>(++updates_[i]));
  }
  constexpr size_t kGrain = 4096;
  parallel_for(size, kGrain, [&](size_t begin, size_t end) {
    for (int p = 0; p < gaussians.planes(); ++p) {
      const float rate = rate_of(p, gaussians, rates);
      float* value = gaussians.plane(p);
      const float* gradient = gradients.plane(p);
      float* m = first_.plane(p);
      float* v = second_.plane(p);
      for (size_t i = begin; i < end; ++i) {
        if (corrections[i] == 0) {
          continue;
        }
        value[i] -= advance(gradient[i], rate * corrections[i], m[i], v[i]);
      }
    }
  });
}

void Adam::reset(size_t i) {
  for (int p = 0; p < first_.planes(); ++p) {
    first_.plane(p)[i] = 0;
    second_.plane(p)[i] = 0;
  }
  updates_[i] = 0;
}

void Adam::resize(size_t size) {
  first_ = resized(first_, size);
  second_ = resized(second_, size);
  updates_.resize(size, 0);
}

Gaussians resized(const Gaussians& from, size_t size) {
  Gaussians to = from.like(size);
  for (int p = 0; p < from.planes(); ++p) {
    std::copy_n(from.plane(p), std::min(size, from.size()), to.plane(p));
  }
  return to;
}

}  // namespace clipgs
