#include "study/holm.h"

#include <algorithm>
#include <numeric>

#include "core/error.h"

namespace clipgs {

std::vector<double> holm(std::span<const double> p) {
  std::vector<size_t> order(p.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::sort(order, {}, [&](size_t i) { return p[i]; });
  std::vector<double> corrected(p.size());
  double least = 0;
  for (size_t k = 0; k < order.size(); ++k) {
    const double one = p[order[k]];
    if (!(one >= 0 && one <= 1)) {
      throw Error("{} is no p-value; Holm's correction takes those of tests, 0 to 1", one);
    }
    least = std::max(least, std::min(1.0, one * static_cast<double>(p.size() - k)));
    corrected[order[k]] = least;
  }
  return corrected;
}

}  // namespace clipgs
