#include "volume/slice_flood.h"

#include "core/parallel.h"

namespace clipgs {

std::vector<std::uint8_t> flood_slices(const IVec3& dims, const std::vector<std::uint8_t>& mask) {
  std::vector<std::uint8_t> reached(mask.size(), 0);
  const size_t slice = static_cast<size_t>(dims.x) * dims.y;
  parallel_for(static_cast<size_t>(dims.z), 1, [&](size_t z, size_t) {
    std::vector<glm::ivec2> stack;
    const auto visit = [&](int x, int y) {
      const size_t at = z * slice + static_cast<size_t>(y) * dims.x + static_cast<size_t>(x);
      if (mask[at] == 0 && reached[at] == 0) {
        reached[at] = 1;
        stack.emplace_back(x, y);
      }
    };
    for (int x = 0; x < dims.x; ++x) {
      visit(x, 0);
      visit(x, dims.y - 1);
    }
    for (int y = 0; y < dims.y; ++y) {
      visit(0, y);
      visit(dims.x - 1, y);
    }
    while (!stack.empty()) {
      const glm::ivec2 at = stack.back();
      stack.pop_back();
      for (const int step : {-1, 1}) {
        if (at.x + step >= 0 && at.x + step < dims.x) {
          visit(at.x + step, at.y);
        }
        if (at.y + step >= 0 && at.y + step < dims.y) {
          visit(at.x, at.y + step);
        }
      }
    }
  });
  return reached;
}

}  // namespace clipgs
