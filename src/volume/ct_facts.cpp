#include "volume/ct_facts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/parallel.h"
#include "volume/coarse_volume.h"
#include "volume/ct_contrast.h"
#include "volume/isolate_body.h"
#include "volume/slice_flood.h"

namespace clipgs {
namespace {

constexpr float kLungAir = -500;  // HU; lung has less
constexpr float kBoneHu = 200;    // HU of a block that holds a thin wall of bone

// Shares of the body's area in a slice. Of real heads 0.5 to 0.8 lie within the skull, of a trunk
// less than 0.15 within bone; lungs fill 0.1 to 0.35 of a chest, gas less than 0.1 of an abdomen.
constexpr float kLeastInSkull = 0.45f;
constexpr float kLeastLung = 0.1f;

// Areas of the body in a slice, cm².
constexpr float kLeastHead = 60;
constexpr float kMostHead = 450;
constexpr float kLeastChest = 150;
constexpr float kLeastTrunk = 250;

struct SliceFacts {
  float body = 0;        // cm²
  float lung = 0;        // share of the body
  float bone = 0;        // share of the body
  float enclosed = 0;    // by bone, share of the body
  float bone_front = 0;  // mm that the middle of bone lies in front of that of the body

  bool is_skull() const {
    return enclosed >= kLeastInSkull && body >= kLeastHead && body <= kMostHead;
  }
  bool is_chest() const { return lung >= kLeastLung && body >= kLeastChest && !is_skull(); }
  bool is_trunk() const { return body >= kLeastTrunk && !is_chest() && !is_skull(); }
};

/// 1 where a slice's flood from its border through what is below `least` does not come.
std::vector<std::uint8_t> enclosed_by(const CoarseVolume& coarse, size_t slice, float least) {
  std::vector<std::uint8_t> mask(coarse.slice());
  for (size_t i = 0; i < mask.size(); ++i) {
    mask[i] = coarse.values[slice * mask.size() + i] > least ? 1 : 0;
  }
  std::vector<std::uint8_t> inside = flood_slices({coarse.dims.x, coarse.dims.y, 1}, mask);
  std::ranges::for_each(inside, [](std::uint8_t& one) { one = one == 0 ? 1 : 0; });
  return inside;
}

/// Marks in `in_skull` what the slice's skull encloses, if it shows one.
SliceFacts slice_facts(const CoarseVolume& coarse, size_t slice,
                       std::vector<std::uint8_t>& in_skull) {
  const std::vector<std::uint8_t> body = enclosed_by(coarse, slice, kLeastMatter);
  const std::vector<std::uint8_t> in_bone = enclosed_by(coarse, slice, kBoneHu);
  double all = 0;
  double lung = 0;
  double bone = 0;
  double enclosed = 0;
  double body_y = 0;
  double bone_y = 0;
  for (size_t i = 0; i < body.size(); ++i) {
    const float hu = coarse.values[slice * body.size() + i];
    const size_t row = i / static_cast<size_t>(coarse.dims.x);
    const auto y = static_cast<double>(row);
    all += body[i];
    body_y += body[i] * y;
    lung += body[i] != 0 && hu < kLungAir ? 1 : 0;
    enclosed += in_bone[i];
    bone += hu > kBoneHu ? 1 : 0;
    bone_y += hu > kBoneHu ? y : 0;
  }
  SliceFacts facts;
  if (all == 0) {
    return facts;
  }
  facts.body = static_cast<float>(all) * coarse.spacing.x * coarse.spacing.y / 100;
  facts.lung = static_cast<float>(lung / all);
  facts.bone = static_cast<float>(bone / all);
  facts.enclosed = static_cast<float>(enclosed / all);
  if (bone > 0) {
    facts.bone_front = static_cast<float>(bone_y / bone - body_y / all) * coarse.spacing.y;
  }
  if (facts.is_skull()) {
    std::ranges::copy(in_bone,
                      in_skull.begin() + static_cast<std::ptrdiff_t>(slice * in_bone.size()));
  }
  return facts;
}

/// Lengths, mm, of what is told of slices.
void measure(const std::vector<SliceFacts>& slices, float thickness, CtFacts& facts) {
  double body = 0;
  double bone = 0;
  for (const SliceFacts& slice : slices) {
    facts.height += thickness;
    facts.skull += slice.is_skull() ? thickness : 0;
    facts.lungs += slice.is_chest() ? thickness : 0;
    facts.trunk += slice.is_trunk() ? thickness : 0;
    body += slice.body;
    bone += static_cast<double>(slice.bone) * slice.body;
  }
  facts.bone = body > 0 ? static_cast<float>(bone / body) : 0;
}

struct RegionRow {
  BodyRegion region;
  bool (*fits)(const CtFacts&);
};

/// The first that fits.
constexpr std::array kRegions = {
    RegionRow{BodyRegion::kWhole,
              [](const CtFacts& f) { return f.skull >= 40 && f.lungs >= 100 && f.trunk >= 100; }},
    RegionRow{BodyRegion::kHead, [](const CtFacts& f) { return f.skull >= 30; }},
    RegionRow{BodyRegion::kTrunk, [](const CtFacts& f) { return f.lungs >= 80 && f.trunk >= 200; }},
    RegionRow{BodyRegion::kChest,
              [](const CtFacts& f) { return f.lungs >= 80 || f.lungs >= 0.4f * f.height; }},
    RegionRow{BodyRegion::kAbdomen, [](const CtFacts& f) { return f.trunk >= 0.5f * f.height; }},
    RegionRow{BodyRegion::kLimb, [](const CtFacts& f) { return f.bone >= 0.02f; }},
    RegionRow{BodyRegion::kUnknown, [](const CtFacts&) { return true; }}};

/// Mean height (in slices) of those that are told.
template <typename Is>
double middle_of(const std::vector<SliceFacts>& slices, const Is& is) {
  double sum = 0;
  double count = 0;
  for (size_t i = 0; i < slices.size(); ++i) {
    if (is(slices[i])) {
      sum += static_cast<double>(i);
      count += 1;
    }
  }
  return sum / std::max(count, 1.0);
}

/// Of a head, the neck and shoulders lie below the skull; of a trunk, the abdomen below the lungs,
/// and the spine behind.
std::string doubt_of(const std::vector<SliceFacts>& slices, float thickness, BodyRegion region) {
  constexpr double kFarther = 20;          // mm
  constexpr float kMostSpineInFront = 15;  // mm; -20 to -45 in those tried
  const auto is_skull = [](const SliceFacts& s) { return s.is_skull(); };
  const auto is_chest = [](const SliceFacts& s) { return s.is_chest(); };
  const auto is_trunk = [](const SliceFacts& s) { return s.is_trunk(); };
  const auto is_rest = [](const SliceFacts& s) { return s.body > 0 && !s.is_skull(); };
  const double head = middle_of(slices, is_skull) - middle_of(slices, is_rest);
  const double chest = middle_of(slices, is_chest) - middle_of(slices, is_trunk);
  if ((region == BodyRegion::kHead || region == BodyRegion::kWhole) &&
      head * thickness < -kFarther) {
    return "the skull lies below the rest of the body: it may be upside down";
  }
  if (region == BodyRegion::kTrunk && chest * thickness < -kFarther) {
    return "the lungs lie below the abdomen: it may be upside down";
  }
  double front = 0;
  double area = 0;
  for (const SliceFacts& slice : slices) {
    if (slice.is_chest() || slice.is_trunk()) {
      front += static_cast<double>(slice.bone_front) * slice.body;
      area += slice.body;
    }
  }
  const bool trunk = region == BodyRegion::kTrunk || region == BodyRegion::kChest ||
                     region == BodyRegion::kAbdomen;
  return trunk && front > kMostSpineInFront * area
             ? "the spine lies in front: front and back may be the other way round"
             : "";
}

}  // namespace

CtFacts ct_facts(const Volume& volume) {
  const CoarseVolume coarse = coarse_volume(volume);
  std::vector<SliceFacts> slices(static_cast<size_t>(coarse.dims.z));
  std::vector<std::uint8_t> in_skull(coarse.values.size());
  parallel_for(slices.size(), 1,
               [&](size_t z, size_t) { slices[z] = slice_facts(coarse, z, in_skull); });
  CtFacts facts;
  measure(slices, coarse.spacing.z, facts);
  facts.region =
      std::ranges::find_if(kRegions, [&](const RegionRow& row) { return row.fits(facts); })->region;
  facts.doubt = doubt_of(slices, coarse.spacing.z, facts.region);
  facts.contrast = facts.region == BodyRegion::kHead ? find_brain_contrast(coarse, in_skull)
                                                     : find_contrast(coarse);
  return facts;
}

}  // namespace clipgs
