#include "volume/brain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "volume/coarse_volume.h"
#include "volume/components.h"
#include "volume/dilate.h"
#include "volume/distance.h"
#include "volume/matter.h"
#include "volume/slice_flood.h"

namespace clipgs {
namespace {

constexpr float kNoBlock = std::numeric_limits<float>::lowest();  // of the layer around

// Of a CT.
constexpr float kSoftFrom = -20;     // HU; fat has less
constexpr float kBlockOfBone = 200;  // HU of a block that holds a thin wall of bone
constexpr float kThickInCt = 9;      // mm off every surface: no nerve, vessel or cord is left
constexpr float kLeastCore = 50;     // ml
constexpr float kLeastBone = 0.35f;  // of what lies within 1 cm of it; 0.63 in those tried
constexpr float kBoneReach = 10;     // mm

// Of an MR: its signal, of that in the middle of the head. The lowest lets in most of the brain,
// the others part it from orbits behind thin bone.
constexpr std::array kLeastSignals = {0.5f, 0.6f, 0.7f};
constexpr float kThickInMr = 6;      // mm; sulci leave less than in a CT
constexpr float kCortex = 4;         // mm that may be missing where gyri are thin
constexpr float kHeadHeight = 150;   // mm from the top that the brain lies in
constexpr float kMiddleRadius = 50;  // mm
constexpr float kLeastSlice = 30;    // cm² of matter: the top of the head, not noise

constexpr float kSulcus = 6;     // mm, half of what is closed
constexpr float kThickAll = 10;  // mm off every surface of that: no orbit hangs on it any more
constexpr float kGivenBack = 2;  // mm more that come back

constexpr float kThickerThanEars = 8;  // mm, half of it

// A brain's size, of infants as well.
constexpr float kLeastBrain = 400;  // ml
constexpr float kMostBrain = 2300;
constexpr Vec2 kBrainLength(110, 215);  // mm
constexpr Vec2 kBrainWidth(85, 175);
constexpr float kMostCut = 10;  // cm² of it in the first or last slice; a spinal cord has 3

constexpr int kMostTurn = 45;     // degrees
constexpr float kUsualPitch = 3;  // degrees: of the longest lines through a level brain, seen aside

// What lies around the upper half of the brain, and before its front, in an MR: dark bone, and the
// scalp around that. Signals are those of the middle.
constexpr Vec2 kSkull(3, 7);  // mm from it
constexpr Vec2 kScalp(8, 20);
constexpr float kMostOfSkull = 0.8f;    // its median
constexpr float kMostInFront = 0.7f;    // its median there
constexpr float kLeastOfScalp = 0.08f;  // share of it that is no background

constexpr Vec3 kBulbs(10, 50, 6);  // mm from the middle, from the front, and above the floor there
constexpr float kBulbHeight = 6;   // mm

// No brain lies in front of this, lower than its middle there, and to a side.
constexpr float kOrbitDepth = 35;     // mm from the front
constexpr float kPoleDepth = 25;      // mm from the front
constexpr float kMedial = 6;          // mm from the middle
constexpr float kLateral = 12;        // mm from the middle
constexpr float kAboveOrbits = 10;    // mm above that floor
constexpr float kMostInOrbit = 1.5f;  // ml on a side

constexpr const char* kNoHead =
    "there is no head in it, or none whose brain is told for sure; leave --deface out if there is "
    "none, or take the face off with another program first";
constexpr const char* kCut =
    "the picture ends within the brain, so that it cannot be told from a face; leave --deface out "
    "if there is none in it";
constexpr const char* kNothingAround =
    "it shows a brain and nothing around it, so that there is no face to take off; leave --deface "
    "out";

/// With a layer of kNoBlock around it.
CoarseVolume with_layer(const CoarseVolume& inner) {
  CoarseVolume outer;
  outer.dims = inner.dims + 2;
  outer.spacing = inner.spacing;
  outer.values.assign(outer.slice() * outer.dims.z, kNoBlock);
  for (int z = 0; z < inner.dims.z; ++z) {
    for (int y = 0; y < inner.dims.y; ++y) {
      const auto from = static_cast<std::ptrdiff_t>(inner.offset({0, y, z}));
      std::copy_n(
          inner.values.begin() + from, inner.dims.x,
          outer.values.begin() + static_cast<std::ptrdiff_t>(outer.offset({1, y + 1, z + 1})));
    }
  }
  return outer;
}

template <typename Decide>
BitMask blocks_where(const CoarseVolume& blocks, const Decide& decide) {
  return mask_where(blocks.values.size(), [&](size_t i) { return decide(blocks.values[i]); });
}

BitMask grown(const CoarseVolume& blocks, const BitMask& mask, float radius) {
  return dilated(blocks.dims, blocks.spacing, mask, radius);
}

BitMask shrunk(const CoarseVolume& blocks, const BitMask& mask, float radius) {
  return eroded(blocks.dims, blocks.spacing, mask, radius);
}

/// The component of the mask that a block is of.
BitMask part_at(const CoarseVolume& blocks, BitMask mask, size_t seed) {
  BitMask part(mask.size());
  take_component(blocks.dims, seed, mask, [&](size_t at) { part.set(at); });
  return part;
}

/// Calls use(seed, ml) for a block of each component.
template <typename Use>
void for_each_part(const CoarseVolume& blocks, BitMask mask, const Use& use) {
  for_each_component(mask, [&](size_t seed) {
    size_t size = 0;
    take_component(blocks.dims, seed, mask, [&](size_t) { ++size; });
    use(seed, static_cast<float>(size) * blocks.ml());
  });
}

BitMask largest_part(const CoarseVolume& blocks, const BitMask& mask) {
  size_t largest = 0;
  float most = 0;
  for_each_part(blocks, mask, [&](size_t seed, float ml) {
    largest = ml > most ? seed : largest;
    most = std::max(most, ml);
  });
  return most > 0 ? part_at(blocks, mask, largest) : mask;
}

/// What a core of `tissue` that has lost `thick` mm is the inside of, without what hangs on it by
/// less than 2 cm.
BitMask brain_around(const CoarseVolume& blocks, const BitMask& tissue, const BitMask& core,
                     float thick) {
  const BitMask inside = blocks_where(blocks, [](float value) { return value != kNoBlock; });
  const BitMask rough = both(grown(blocks, core, thick + kGivenBack), tissue);
  const BitMask closed = both(shrunk(blocks, grown(blocks, rough, kSulcus), kSulcus), inside);
  const BitMask main = largest_part(blocks, shrunk(blocks, closed, kThickAll));
  return both(grown(blocks, main, kThickAll + kGivenBack), closed);
}

/// Of the thick parts of soft tissue that which most bone lies around; nothing if that is little.
BitMask core_within_bone(const CoarseVolume& blocks, const BitMask& soft) {
  const BitMask bone = blocks_where(blocks, [](float hu) { return hu > kBlockOfBone; });
  const BitMask thick = shrunk(blocks, soft, kThickInCt);
  BitMask best(thick.size());
  double most = kLeastBone;
  for_each_part(blocks, thick, [&](size_t seed, float ml) {
    if (ml < kLeastCore) {
      return;
    }
    BitMask part = part_at(blocks, thick, seed);
    const BitMask shell =
        without(grown(blocks, part, kThickInCt + kBoneReach), grown(blocks, part, kThickInCt));
    const double share = static_cast<double>(both(shell, bone).count()) /
                         static_cast<double>(std::max(shell.count(), size_t{1}));
    if (share > most) {
      most = share;
      best = std::move(part);
    }
  });
  return best;
}

/// The direction, degrees from the first coordinate to the second, that the points reach far along:
/// the mean of those with nearly their greatest length, which alone would be that of a few blocks.
float long_direction(const std::vector<Vec2>& points) {
  constexpr float kNearly = 0.95f;
  std::vector<float> lengths;
  for (int degrees = -kMostTurn; degrees <= kMostTurn; ++degrees) {
    const float angle = glm::radians(static_cast<float>(degrees));
    const Vec2 along(std::cos(angle), std::sin(angle));
    const auto [low, high] =
        std::ranges::minmax(points, {}, [&](const Vec2& point) { return glm::dot(point, along); });
    lengths.push_back(glm::dot(high - low, along));
  }
  const float least = kNearly * *std::ranges::max_element(lengths);
  float sum = 0;
  float weights = 0;
  for (size_t i = 0; i < lengths.size(); ++i) {
    const float weight = std::max(lengths[i] - least, 0.0f);
    weights += weight;
    sum += weight * (static_cast<float>(i) - kMostTurn);
  }
  return sum / weights;
}

/// The direction, degrees from the first coordinate to the second, of their first principal axis.
float main_direction(const std::vector<Vec2>& points) {
  glm::dvec2 sum(0);
  for (const Vec2& point : points) {
    sum += glm::dvec2(point);
  }
  const glm::dvec2 mean = sum / static_cast<double>(std::max(points.size(), size_t{1}));
  glm::dvec2 squares(0);
  double product = 0;
  for (const Vec2& point : points) {
    const glm::dvec2 away = glm::dvec2(point) - mean;
    squares += away * away;
    product += away.x * away.y;
  }
  return static_cast<float>(glm::degrees(0.5 * std::atan2(2 * product, squares.x - squares.y)));
}

/// Where the mask is seen along an axis: the other coordinates, mm, that of y first.
std::vector<Vec2> seen_along(const CoarseVolume& blocks, const BitMask& mask, int axis) {
  const int other = 2 - axis;  // x of what is seen along z, and z along x
  std::vector<std::uint8_t> seen(static_cast<size_t>(blocks.dims.y) * blocks.dims[other]);
  for (size_t i = mask.next(0); i < mask.size(); i = mask.next(i + 1)) {
    const IVec3 place = blocks.place(i);
    seen[static_cast<size_t>(place[other]) * blocks.dims.y + place.y] = 1;
  }
  std::vector<Vec2> points;
  const auto height = static_cast<size_t>(blocks.dims.y);
  for (size_t i = 0; i < seen.size(); ++i) {
    if (seen[i] != 0) {
      const size_t row = i / height;
      points.emplace_back(static_cast<float>(i % height) * blocks.spacing.y,
                          static_cast<float>(row) * blocks.spacing[other]);
    }
  }
  return points;
}

/// cm² of the mask in the volume's first and in its last slice along an axis, the larger one.
float cut_by_border(const CoarseVolume& blocks, const BitMask& mask, int axis) {
  std::array<size_t, 2> counts{};
  for (size_t i = mask.next(0); i < mask.size(); i = mask.next(i + 1)) {
    const int at = blocks.place(i)[axis];
    counts[0] += at == 1 ? 1 : 0;
    counts[1] += at == blocks.dims[axis] - 2 ? 1 : 0;
  }
  const float area = blocks.ml() / blocks.spacing[axis] * 10;  // 1 ml is 10 cm² of 1 mm
  return static_cast<float>(std::max(counts[0], counts[1])) * area;
}

/// The head's right, front and top, of the blocks' axes.
Mat3 head_axes(const CoarseVolume& blocks, const BitMask& mask) {
  constexpr float kMost = kMostTurn;
  const float yaw = glm::clamp(main_direction(seen_along(blocks, mask, 2)), -kMost, kMost);
  const bool whole = cut_by_border(blocks, mask, 2) <= kMostCut;  // slabs are laid level
  const float pitch = whole ? long_direction(seen_along(blocks, mask, 0)) - kUsualPitch : 0;
  const Vec3 front =
      glm::normalize(Vec3(std::tan(glm::radians(yaw)), 1, std::tan(glm::radians(pitch))));
  const Vec3 top = glm::normalize(Vec3(0, 0, 1) - front.z * front);
  return {glm::cross(front, top), front, top};
}

/// All that is asked of a mask that may be a brain.
struct Candidate {
  const CoarseVolume& blocks;
  BitMask mask;
  Mat3 head{1};
  Box bounds{};  // mm along the head's axes
  float ml = 0;

  Candidate(const CoarseVolume& where, BitMask what)
      : blocks(where), mask(std::move(what)), ml(static_cast<float>(mask.count()) * where.ml()) {
    if (ml < kLeastBrain) {
      return;
    }
    head = head_axes(blocks, mask);
    for (size_t i = mask.next(0); i < mask.size(); i = mask.next(i + 1)) {
      bounds.add(at(i));
    }
  }

  /// mm to the head's right, front and top.
  Vec3 at(size_t block) const { return (Vec3(blocks.place(block)) * blocks.spacing) * head; }

  bool has_size() const {
    const auto within = [](float value, const Vec2& range) {
      return value >= range.x && value <= range.y;
    };
    return ml >= kLeastBrain && ml <= kMostBrain && within(bounds.size().y, kBrainLength) &&
           within(bounds.size().x, kBrainWidth);
  }
  bool is_cut() const {
    return ml >= kLeastBrain &&
           (cut_by_border(blocks, mask, 0) > kMostCut || cut_by_border(blocks, mask, 1) > kMostCut);
  }
  /// Of its front, in the middle, above the nose.
  float floor() const {
    float floor = bounds.max.z;
    for (size_t i = mask.next(0); i < mask.size(); i = mask.next(i + 1)) {
      const Vec3 place = at(i) - Vec3(bounds.center().x, bounds.max.y, 0);
      if (place.y > -kPoleDepth && std::abs(place.x) < kMedial) {
        floor = std::min(floor, place.z);
      }
    }
    return floor;
  }
  /// Whether some of it lies where orbits do, on either side.
  bool reaches_orbits() const {
    const Vec3 middle(bounds.center().x, bounds.max.y, floor());
    std::array<size_t, 2> low{};
    for (size_t i = mask.next(0); i < mask.size(); i = mask.next(i + 1)) {
      const Vec3 place = at(i) - middle;
      low[place.x > 0 ? 1 : 0] +=
          place.y > -kOrbitDepth && std::abs(place.x) > kLateral && place.z < 0 ? 1 : 0;
    }
    return static_cast<float>(std::max(low[0], low[1])) * blocks.ml() > kMostInOrbit;
  }
};

/// With what lies next to the floor of its front in the middle: the olfactory bulbs, which are too
/// thin to be told from the bone around them.
BitMask with_bulbs(const Candidate& found) {
  const Vec3 middle(found.bounds.center().x, found.bounds.max.y, found.floor());
  BitMask floor(found.mask.size());
  for (size_t i = found.mask.next(0); i < found.mask.size(); i = found.mask.next(i + 1)) {
    const Vec3 place = found.at(i) - middle;
    if (std::abs(place.x) < kBulbs.x && place.y > -kBulbs.y && place.z < kBulbs.z) {
      floor.set(i);
    }
  }
  BitMask mask = grown(found.blocks, floor, kBulbHeight);
  mask.combine(found.mask, [](std::uint64_t a, std::uint64_t b) { return a | b; });
  return mask;
}

BitMask body_of(const CoarseVolume& blocks, float least) {
  const BitMask matter = blocks_where(blocks, [&](float value) { return value > least; });
  const BitMask filled = flood_slices(blocks.dims, matter).inverted();
  return grown(blocks, shrunk(blocks, filled, kThickerThanEars), kThickerThanEars);
}

Brain brain_of(const Candidate& candidate, const Volume& volume, float least) {
  const CoarseVolume& blocks = candidate.blocks;
  const Vec3 factor = blocks.spacing / volume.spacing;
  Brain brain;
  brain.dims = blocks.dims;
  brain.spacing = blocks.spacing;
  brain.origin = volume.world_from_index(-0.5f * (factor + 1.0f));
  brain.direction = volume.direction;
  brain.mask = with_bulbs(candidate);
  brain.body = body_of(blocks, least);
  brain.ml = candidate.ml;
  brain.head = volume.direction * candidate.head;
  const Vec3 shift = brain.origin * brain.head;
  brain.bounds = {candidate.bounds.min + shift, candidate.bounds.max + shift};
  brain.floor = candidate.floor() + shift.z;
  return brain;
}

BrainSearch brain_of_ct(const Volume& volume, const CoarseVolume& blocks) {
  const float least = least_matter(volume);
  const BitMask soft =
      blocks_where(blocks, [](float hu) { return hu > kSoftFrom && hu <= kBlockOfBone; });
  const BitMask core = core_within_bone(blocks, soft);
  const Candidate found(blocks, brain_around(blocks, soft, core, kThickInCt));
  if (found.has_size() && !found.is_cut() && !found.reaches_orbits()) {
    return {brain_of(found, volume, least), ""};
  }
  return {std::nullopt, found.is_cut() ? kCut : kNoHead};
}

float median_of(std::vector<float> values) {
  if (values.empty()) {
    return 0;
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// The signal in the middle of what lies at the top; 0 if nothing does.
float middle_signal(const CoarseVolume& blocks, float least) {
  const float block_area = blocks.ml() / blocks.spacing.z * 10;  // cm²
  double count = 0;
  glm::dvec3 sum(0);
  float top = -1;  // mm
  for (int z = blocks.dims.z - 1; z >= 0; --z) {
    const float height = static_cast<float>(z) * blocks.spacing.z;
    if (top >= 0 && height < top - kHeadHeight) {
      break;
    }
    double here = 0;
    glm::dvec3 places(0);
    for (size_t i = blocks.offset({0, 0, z}); i < blocks.offset({0, 0, z + 1}); ++i) {
      if (blocks.values[i] > least) {
        here += 1;
        places += glm::dvec3(blocks.place(i));
      }
    }
    if (top < 0 && here * block_area < kLeastSlice) {
      continue;
    }
    top = top < 0 ? height : top;
    count += here;
    sum += places;
  }
  const Vec3 middle = Vec3(sum / std::max(count, 1.0)) * blocks.spacing;
  std::vector<float> near;
  for (size_t i = 0; i < blocks.values.size(); ++i) {
    if (blocks.values[i] > least &&
        glm::distance(Vec3(blocks.place(i)) * blocks.spacing, middle) < kMiddleRadius) {
      near.push_back(blocks.values[i]);
    }
  }
  return median_of(std::move(near));
}

struct Wrapping {
  float skull = 0;  // median signal of what lies where the skull does
  float front = 0;  // the same of what lies before the brain
  float scalp = 0;  // share of matter where the scalp lies
};

/// What lies around the upper half.
Wrapping wrapping_of(const Candidate& found, float least) {
  const CoarseVolume& blocks = found.blocks;
  const std::vector<float> away =
      distances_to(blocks.dims, blocks.spacing, found.mask, kScalp.y + 1);
  const auto lies_in = [&](size_t i, const Vec2& shell) {
    return away[i] > shell.x && away[i] < shell.y;
  };
  const float above_orbits = found.floor() + kAboveOrbits;
  std::vector<float> skull;
  std::vector<float> front;
  double scalp = 0;
  double matter = 0;
  for (size_t i = 0; i < away.size(); ++i) {
    if (blocks.values[i] == kNoBlock) {
      continue;
    }
    const Vec3 place = found.at(i);
    const bool is_up = place.z > found.bounds.center().z;
    if (lies_in(i, kSkull)) {
      if (is_up) {
        skull.push_back(blocks.values[i]);
      }
      if (place.y > found.bounds.max.y - kPoleDepth && place.z > above_orbits) {
        front.push_back(blocks.values[i]);
      }
    } else if (lies_in(i, kScalp) && is_up) {
      scalp += 1;
      matter += blocks.values[i] > least ? 1 : 0;
    }
  }
  return {median_of(std::move(skull)), median_of(std::move(front)),
          static_cast<float>(matter / std::max(scalp, 1.0))};
}

/// Adds what of `tissue` lies next to it above the orbits: thin gyri.
void add_cortex(const Candidate& found, const BitMask& tissue, BitMask& mask) {
  const BitMask near = both(grown(found.blocks, found.mask, kCortex), tissue);
  const float above_orbits = found.floor() + kAboveOrbits;
  for (size_t i = near.next(0); i < near.size(); i = near.next(i + 1)) {
    if (found.at(i).z > above_orbits) {
      mask.set(i);
    }
  }
}

BrainSearch brain_of_mr(const Volume& volume, const CoarseVolume& blocks) {
  const float least = least_matter(volume);
  const float signal = middle_signal(blocks, least);
  const auto tissue_of = [&](float share) {
    return blocks_where(blocks,
                        [&](float value) { return value > std::max(share * signal, least); });
  };
  const char* why_not = kNoHead;
  for (const float share : kLeastSignals) {
    const BitMask tissue = tissue_of(share);
    const BitMask core = largest_part(blocks, shrunk(blocks, tissue, kThickInMr));
    const Candidate found(blocks, brain_around(blocks, tissue, core, kThickInMr));
    if (found.is_cut()) {
      why_not = kCut;
    }
    if (!found.has_size() || found.is_cut()) {
      continue;
    }
    const Wrapping wrapping = wrapping_of(found, least);
    if (wrapping.scalp < kLeastOfScalp) {
      why_not = kNothingAround;
    } else if (wrapping.skull < kMostOfSkull * signal && wrapping.front < kMostInFront * signal &&
               !found.reaches_orbits()) {
      Brain brain = brain_of(found, volume, least);
      add_cortex(found, tissue_of(kLeastSignals.front()), brain.mask);
      return {std::move(brain), ""};
    }
  }
  return {std::nullopt, why_not};
}

}  // namespace

Vec3 Brain::place(size_t block) const {
  return origin + direction * (Vec3(place_of(dims, block)) * spacing);
}

BrainSearch find_brain(const Volume& volume) {
  const CoarseVolume blocks = with_layer(coarse_volume(volume));
  return volume.modality == Modality::kCt ? brain_of_ct(volume, blocks)
                                          : brain_of_mr(volume, blocks);
}

}  // namespace clipgs
