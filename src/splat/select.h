#pragma once

#include <cstddef>
#include <vector>

#include "splat/gaussians.h"

namespace clipgs {

/// The Gaussians for whose index keeps(i) is true, in their order.
template <typename Keeps>
Gaussians select(const Gaussians& gaussians, const Keeps& keeps) {
  std::vector<size_t> kept;
  for (size_t i = 0; i < gaussians.size(); ++i) {
    if (keeps(i)) {
      kept.push_back(i);
    }
  }
  return gaussians.gather(kept);
}

}  // namespace clipgs
