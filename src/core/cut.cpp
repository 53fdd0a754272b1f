#include "core/cut.h"

#include <algorithm>

#include "core/error.h"

namespace clipgs {

bool are_opposite(const Plane& a, const Plane& b) {
  return glm::dot(a.normal, b.normal) < -1 + 1e-6f;
}

Cut::Cut(std::vector<Plane> planes) {
  if (planes.size() > kMostPlanes) {
    throw Error("{} planes are more than the {} that a cut can have", planes.size(), kMostPlanes);
  }
  while (!planes.empty()) {
    const Plane plane = planes.front();
    planes.erase(planes.begin());
    planes_.push_back(plane);
    const auto other =
        std::ranges::find_if(planes, [&](const Plane& p) { return are_opposite(plane, p); });
    if (other != planes.end()) {
      planes_.push_back(*other);
      planes.erase(other);
    }
  }
}

}  // namespace clipgs
