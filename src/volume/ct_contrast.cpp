#include "volume/ct_contrast.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <utility>

#include "volume/isolate_body.h"

namespace clipgs {
namespace {

constexpr float kLeastBlood = 130;   // HU; muscle and organs without contrast have less than 80
constexpr float kMostBlood = 600;    // HU
constexpr float kLeastVessel = 8;    // ml; what is smaller may be marrow or calcified cartilage
constexpr float kLeastTall = 30;     // mm, or most of what was scanned
constexpr float kThick = 4;          // mm of such matter all around; cartilage of ribs is thinner
constexpr float kLeastDeep = 1;      // ml that lie so deep
constexpr float kAside = 65;         // mm from the middle; the heads of the femora lie beyond
constexpr float kBrighter = 60;      // HU above the mean
constexpr float kMostLined = 0.25f;  // of what is around; 0.3 to 0.4 of marrow, 0.2 of an aorta
constexpr float kLining = 4;         // mm

constexpr float kFromBone = 10;      // mm
constexpr float kAirCell = -100;     // HU; of sinuses and the ear, with thin walls of bone
constexpr float kMostBright = 0.1f;  // of what is that near; the edge of bone has more
constexpr float kLeastInBrain = 2;   // ml; calcified plexus and pineal gland have less

constexpr std::array kBesides = {IVec3(1, 0, 0), IVec3(0, 1, 0), IVec3(0, 0, 1)};

/// Of these values, and no edge.
bool is_even(const CoarseVolume& coarse, size_t at) {
  const float hu = coarse.values[at];
  if (hu < kLeastBlood || hu > kMostBlood) {
    return false;
  }
  const float edge = 40 + 0.1f * hu;  // twice the noise of blocks, and flow that does not mix
  const IVec3 place = coarse.place(at);
  return std::ranges::all_of(kBesides, [&](const IVec3& step) {
    return coarse.holds(place - step) && coarse.holds(place + step) &&
           std::abs(coarse.values[coarse.offset(place - step)] - hu) < edge &&
           std::abs(coarse.values[coarse.offset(place + step)] - hu) < edge;
  });
}

/// Where the mask is 1 and the blocks within `reach` along each axis are; beyond the grid all is.
bool is_deep(const CoarseVolume& coarse, const std::vector<std::uint8_t>& mask, const IVec3& place,
             float reach) {
  for (int axis = 0; axis < 3; ++axis) {
    const float blocks = std::max(1.0f, reach / coarse.spacing[axis]);
    const int steps = static_cast<int>(std::min(blocks, static_cast<float>(coarse.dims[axis])));
    for (int step = -steps; step <= steps; ++step) {
      IVec3 there = place;
      there[axis] += step;
      if (coarse.holds(there) && mask[coarse.offset(there)] == 0) {
        return false;
      }
    }
  }
  return true;
}

/// Calls use(offset) for each block of the box around a place.
template <typename Use>
void for_each_around(const CoarseVolume& coarse, const IVec3& place, float reach, const Use& use) {
  const IVec3 steps = glm::max(IVec3(Vec3(reach) / coarse.spacing), IVec3(1));
  const IVec3 low = glm::max(place - steps, IVec3(0));
  const IVec3 high = glm::min(place + steps, coarse.dims - 1);
  for (int z = low.z; z <= high.z; ++z) {
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) {
        use(coarse.offset({x, y, z}));
      }
    }
  }
}

/// The blocks of the mask that hang together with a first one, which are taken off it.
std::vector<size_t> take_part(const CoarseVolume& coarse, size_t seed,
                              std::vector<std::uint8_t>& left) {
  std::vector<size_t> part{seed};
  left[seed] = 0;
  for (size_t i = 0; i < part.size(); ++i) {
    const IVec3 place = coarse.place(part[i]);
    for (const IVec3& step : kBesides) {
      for (const IVec3& there : {place - step, place + step}) {
        if (coarse.holds(there) && left[coarse.offset(there)] != 0) {
          left[coarse.offset(there)] = 0;
          part.push_back(coarse.offset(there));
        }
      }
    }
  }
  return part;
}

/// Share of what lies around the part that is brighter than its mean.
float lined_share(const CoarseVolume& coarse, const std::vector<size_t>& part, float mean) {
  std::vector<std::uint8_t> seen(coarse.values.size());
  for (const size_t at : part) {
    seen[at] = 1;
  }
  size_t around = 0;
  size_t brighter = 0;
  for (const size_t at : part) {
    for_each_around(coarse, coarse.place(at), kLining, [&](size_t there) {
      if (std::exchange(seen[there], std::uint8_t{1}) == 0) {
        ++around;
        brighter += coarse.values[there] > mean + kBrighter ? 1 : 0;
      }
    });
  }
  return static_cast<float>(brighter) / static_cast<float>(std::max<size_t>(around, 1));
}

/// Middle of the body from right to left, blocks.
float body_middle(const CoarseVolume& coarse) {
  double sum = 0;
  double count = 0;
  for (size_t i = 0; i < coarse.values.size(); ++i) {
    if (coarse.values[i] > kLeastMatter) {
      sum += coarse.place(i).x;
      count += 1;
    }
  }
  return static_cast<float>(sum / std::max(count, 1.0));
}

float mean_hu(const CoarseVolume& coarse, const std::vector<size_t>& part) {
  double sum = 0;
  for (const size_t at : part) {
    sum += coarse.values[at];
  }
  return static_cast<float>(sum / static_cast<double>(part.size()));
}

/// Whether a part of the mask is a vessel's or the heart's.
bool is_blood(const CoarseVolume& coarse, const std::vector<std::uint8_t>& even,
              const std::vector<size_t>& part, float middle) {
  const float ml = static_cast<float>(part.size()) * coarse.ml();
  if (ml < kLeastVessel) {
    return false;
  }
  int low = coarse.dims.z;
  int high = 0;
  double x = 0;
  size_t core = 0;
  for (const size_t at : part) {
    const IVec3 place = coarse.place(at);
    low = std::min(low, place.z);
    high = std::max(high, place.z);
    x += place.x;
    core += is_deep(coarse, even, place, kThick) ? 1 : 0;
  }
  const float height = static_cast<float>(high - low + 1) * coarse.spacing.z;
  const float scanned = static_cast<float>(coarse.dims.z) * coarse.spacing.z;
  const float aside = std::abs(static_cast<float>(x / static_cast<double>(part.size())) - middle);
  return height >= std::min(kLeastTall, 0.6f * scanned) && aside * coarse.spacing.x <= kAside &&
         static_cast<float>(core) * coarse.ml() >= kLeastDeep &&
         lined_share(coarse, part, mean_hu(coarse, part)) < kMostLined;
}

bool lies_in_brain(const CoarseVolume& coarse, size_t at) {
  size_t all = 0;
  size_t bright = 0;
  bool foreign = false;
  for_each_around(coarse, coarse.place(at), kFromBone, [&](size_t there) {
    const float hu = coarse.values[there];
    ++all;
    bright += hu > kLeastBlood ? 1 : 0;
    foreign = foreign || hu > kMostBlood || hu < kAirCell;
  });
  return !foreign && static_cast<float>(bright) < kMostBright * static_cast<float>(all);
}

}  // namespace

Contrast find_contrast(const CoarseVolume& coarse) {
  std::vector<std::uint8_t> even(coarse.values.size());
  for (size_t i = 0; i < even.size(); ++i) {
    even[i] = is_even(coarse, i) ? 1 : 0;
  }
  const float middle = body_middle(coarse);
  std::vector<std::uint8_t> left = even;
  double blocks = 0;
  double sum = 0;
  for (size_t seed = 0; seed < left.size(); ++seed) {
    if (left[seed] == 0) {
      continue;
    }
    const std::vector<size_t> part = take_part(coarse, seed, left);
    if (is_blood(coarse, even, part, middle)) {
      blocks += static_cast<double>(part.size());
      sum += static_cast<double>(mean_hu(coarse, part)) * static_cast<double>(part.size());
    }
  }
  return {static_cast<float>(blocks) * coarse.ml(),
          static_cast<float>(sum / std::max(blocks, 1.0))};
}

Contrast find_brain_contrast(const CoarseVolume& coarse,
                             const std::vector<std::uint8_t>& in_skull) {
  std::vector<float> bright;
  for (size_t i = 0; i < in_skull.size(); ++i) {
    if (in_skull[i] == 0 || coarse.values[i] < kLeastBlood || coarse.values[i] > kMostBlood) {
      continue;
    }
    if (lies_in_brain(coarse, i)) {
      bright.push_back(coarse.values[i]);
    }
  }
  const float ml = static_cast<float>(bright.size()) * coarse.ml();
  if (ml < kLeastInBrain) {
    return {};
  }
  std::ranges::sort(bright, std::ranges::greater());
  bright.resize(std::max<size_t>(bright.size() / 10, 1));
  const double sum = std::accumulate(bright.begin(), bright.end(), 0.0);
  return {ml, static_cast<float>(sum / static_cast<double>(bright.size()))};
}

}  // namespace clipgs
