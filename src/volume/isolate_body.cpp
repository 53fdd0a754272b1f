#include "volume/isolate_body.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/parallel.h"
#include "volume/bit_mask.h"
#include "volume/components.h"
#include "volume/dilate.h"
#include "volume/slice_flood.h"
#include "volume/smooth_within.h"

namespace clipgs {
namespace {

constexpr float kAir = -1024;           // HU
constexpr float kThinnest = 6;          // mm, half of what a part of the body must be thick
constexpr float kLeastPart = 0.01f;     // of the largest part: arms are, cables are not
constexpr float kLeastMean = -700;      // HU of a part with its holes; hollow tables have less
constexpr float kLeanest = -150;        // HU; fat lies between these two
constexpr float kFattest = -20;         // HU
constexpr double kLeastFat = 0.03;      // of a limb, which has a tenth at least; plastic has none
constexpr float kLongestTrifle = 100;   // mm; no ear or nose is longer, a table is
constexpr float kBone = 300;            // HU; attached to the body, of any length
constexpr float kThickestShell = 1.8f;  // mm, half of what a cover has; a thin chest has more
constexpr float kDense = 250;           // HU; skin is softer, cables and head holders may not be
constexpr float kSkinOverBone = 1.5f;   // mm; no bone lies so near to the air, but bare ones
constexpr double kBare = 0.4;           // of the surface of a dense thing, of what lies outside
constexpr float kBlur = 2;              // mm around a dense thing that are neither it nor air
constexpr float kSeam = 2;              // mm around that which are smoothed
constexpr float kSmooth = 1;            // mm, deviation
constexpr float kDeepRest = 3;          // mm below that or the air; bone is deeper
constexpr float kRest = 90;             // HU; of a dense thing in the skin, which is softer …
constexpr float kSkinValue = 30;        // HU … and becomes this
constexpr double kLeastDense = 0.1;     // ml; noise has less
constexpr float kSkin = 2;              // voxels around the body that keep their values
constexpr double kMostRemoved = 0.35;   // of all matter; more is no table

/// Matter, and all that it encloses in an axial slice: lungs belong to the chest.
BitMask with_holes_filled(const Volume& volume, const BitMask& matter) {
  return flood_slices(volume.dims, matter).inverted();
}

BitMask dilated(const Volume& volume, const BitMask& mask, float radius) {
  return dilated(volume.dims, volume.spacing, mask, radius);
}

BitMask eroded(const Volume& volume, const BitMask& mask, float radius) {
  return eroded(volume.dims, volume.spacing, mask, radius);
}

BitMask opened(const Volume& volume, const BitMask& mask, float radius) {
  return dilated(volume, eroded(volume, mask, radius), radius);
}

/// Makes skin of what is left of dense things that lay on it, and its surface smooth: masks end in
/// steps of whole voxels.
void heal(Volume& volume, const BitMask& bare, const BitMask& filled, float blur) {
  const BitMask seam = dilated(volume, bare, blur + kSeam);
  const BitMask near_air =
      dilated(volume, mask_where(volume.voxels(), [&](size_t i) { return bare[i] || !filled[i]; }),
              kDeepRest);
  const BitMask rests = mask_where(volume.voxels(), [&](size_t i) {
    return seam[i] && near_air[i] && volume.values[i] > kRest;
  });
  volume.values.set_where(kSkinValue, [&](size_t i) { return rests[i]; });
  smooth_within(volume, seam, kSmooth);
}

double voxel_ml(const Volume& volume) {
  const Vec3& s = volume.spacing;
  return double{s.x} * s.y * s.z / 1000;
}

/// Whether a voxel of the mask has a neighbour that is not, in its slice.
bool is_rim(const Volume& volume, const BitMask& mask, size_t at) {
  const IVec3 place = place_of(volume.dims, at);
  const auto width = static_cast<size_t>(volume.dims.x);
  return (place.x > 0 && !mask[at - 1]) || (place.x < volume.dims.x - 1 && !mask[at + 1]) ||
         (place.y > 0 && !mask[at - width]) || (place.y < volume.dims.y - 1 && !mask[at + width]);
}

/// Dense things that lie bare in the air around `filled`, as cables, tubes and the plates of head
/// holders do, also where they touch the skin. Nothing if that is true of the largest of all: of
/// bones without flesh.
BitMask bare_things(const Volume& volume, const BitMask& filled) {
  struct Thing {
    size_t seed;
    size_t size = 0;
    bool bare = false;
  };
  const BitMask dense =
      mask_where(volume.voxels(), [&](size_t i) { return filled[i] && volume.values[i] > kDense; });
  const BitMask near_air = dilated(volume, filled.inverted(), kSkinOverBone);
  std::vector<Thing> things;
  BitMask left = dense;
  for_each_component(left, [&](size_t seed) {
    Thing thing{seed};
    size_t rim = 0;
    size_t in_air = 0;
    take_component(volume.dims, seed, left, [&](size_t at) {
      const bool outer = is_rim(volume, dense, at);
      rim += outer ? 1 : 0;
      in_air += outer && near_air[at] ? 1 : 0;
      ++thing.size;
    });
    thing.bare = static_cast<double>(in_air) >= kBare * static_cast<double>(rim) && rim > 0;
    if (static_cast<double>(thing.size) * voxel_ml(volume) >= kLeastDense) {
      things.push_back(thing);
    }
  });
  BitMask bare(dense.size());
  const auto largest = std::ranges::max_element(things, {}, &Thing::size);
  if (largest == things.end() || largest->bare) {
    return bare;
  }
  left = dense;
  for (const Thing& thing : things) {
    if (thing.bare) {
      take_component(volume.dims, thing.seed, left, [&](size_t at) { bare.set(at); });
    }
  }
  return bare;
}

struct Cores {
  BitMask body;
  size_t foreign = 0;  ///< voxels of it that hold no fat
};

/// The parts of `cores` that are large, and not hollow.
Cores body_cores(const Volume& volume, const BitMask& cores) {
  struct Part {
    size_t seed;
    size_t size = 0;
    size_t fat = 0;
    double sum = 0;
  };
  std::vector<Part> parts;
  size_t largest = 0;
  const auto is_large = [&](const Part& part) {
    return static_cast<double>(part.size) >= kLeastPart * static_cast<double>(largest);
  };
  BitMask left = cores;
  for_each_component(left, [&](size_t seed) {
    Part part{seed};
    take_component(volume.dims, seed, left, [&](size_t at) {
      const float hu = volume.values[at];
      part.sum += hu;
      part.fat += hu > kLeanest && hu < kFattest ? 1 : 0;
      ++part.size;
    });
    largest = std::max(largest, part.size);
    if (is_large(part)) {  // so far: noise must not fill the list
      parts.push_back(part);
    }
  });
  Cores kept{BitMask(cores.size())};
  left = cores;
  for (const Part& part : parts) {
    if (is_large(part) && part.sum / static_cast<double>(part.size) > kLeastMean) {
      take_component(volume.dims, part.seed, left, [&](size_t at) { kept.body.set(at); });
      const bool lean = static_cast<double>(part.fat) < kLeastFat * static_cast<double>(part.size);
      kept.foreign += part.size < largest && lean ? part.size : 0;
    }
  }
  return kept;
}

/// Adds to the body what of the matter is attached to it, and small or bone.
void add_trifles(const Volume& volume, const BitMask& matter, BitMask& body) {
  const Vec3& spacing = volume.spacing;
  const BitMask near = dilated(volume, body, 1.01f * std::max({spacing.x, spacing.y, spacing.z}));
  const BitMask rest = without(matter, body);
  BitMask left = rest;
  BitMask to_add = rest;
  for_each_component(left, [&](size_t seed) {
    IVec3 low = volume.dims;
    IVec3 high(0);
    bool attached = false;
    double sum = 0;
    size_t solid = 0;
    take_component(volume.dims, seed, left, [&](size_t at) {
      const IVec3 place = place_of(volume.dims, at);
      low = glm::min(low, place);
      high = glm::max(high, place);
      attached = attached || near[at];
      if (volume.values[at] > kLeastMatter) {
        sum += volume.values[at];
        ++solid;
      }
    });
    const Vec3 size = Vec3(high - low + 1) * spacing;
    const bool small = std::max({size.x, size.y, size.z}) <= kLongestTrifle;
    if (attached && (small || sum > kBone * static_cast<double>(solid))) {
      take_component(volume.dims, seed, to_add, [&](size_t at) { body.set(at); });
    }
  });
}

/// Takes off what is kept around the body those parts of the matter beside it that lie mostly
/// farther away: of a shell that touches the skin. What lies within all of it is skin.
void drop_ends_of_others(const Volume& volume, const BitMask& beside, BitMask& kept) {
  BitMask left = beside;
  BitMask to_drop = beside;
  for_each_component(left, [&](size_t seed) {
    size_t size = 0;
    size_t near = 0;
    take_component(volume.dims, seed, left, [&](size_t at) {
      ++size;
      near += kept[at] ? 1 : 0;
    });
    if (near > 0 && 2 * near < size) {
      take_component(volume.dims, seed, to_drop, [&](size_t at) { kept.clear(at); });
    }
  });
}

}  // namespace

Isolation isolate_body(Volume& volume) {
  if (volume.modality != Modality::kCt || volume.values.range().min > kLeastMean) {
    return {};
  }
  const BitMask matter =
      mask_where(volume.voxels(), [&](size_t i) { return volume.values[i] > kLeastMatter; });
  const BitMask scanned = with_holes_filled(volume, matter);
  const BitMask bare = bare_things(volume, scanned);
  const bool any_bare = bare.next(0) < bare.size();
  const BitMask clothed = without(matter, bare);
  // What a shell encloses with the body is not of the body.
  BitMask filled = with_holes_filled(volume, opened(volume, clothed, kThickestShell));
  const Vec3& s = volume.spacing;
  // Where slices are thick, rather some of the table than none of an ear that touches it.
  const float voxel = std::max({s.x, s.y, s.z});
  const Cores cores = body_cores(volume, eroded(volume, filled, kThinnest));
  filled.combine(clothed, [](std::uint64_t x, std::uint64_t y) { return x | y; });
  BitMask body = both(dilated(volume, cores.body, kThinnest + 1.5f * voxel), filled);
  add_trifles(volume, filled, body);
  BitMask kept = dilated(volume, body, kSkin * voxel);
  drop_ends_of_others(volume, without(filled, body), kept);
  const float blur = std::max(kBlur, 1.01f * std::min({s.x, s.y, s.z}));
  if (any_bare) {
    // With what is blurred around them, but for the skin below.
    kept =
        without(kept, without(dilated(volume, bare, blur), dilated(volume, cores.body, kThinnest)));
  }

  const auto all = static_cast<double>(matter.count());
  const auto removed = static_cast<double>(without(matter, kept).count());
  if (removed > kMostRemoved * all) {
    return {.unsure = true};
  }
  volume.values.set_where(kAir, [&](size_t i) { return !kept[i]; });
  if (any_bare) {
    heal(volume, bare, scanned, blur);
  }
  const double ml = voxel_ml(volume);
  return {removed * ml, static_cast<double>(cores.foreign) * ml};
}

}  // namespace clipgs
