#include "volume/suitable_presets.h"

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <string_view>

#include "volume/histogram.h"
#include "volume/preset.h"

namespace clipgs {
namespace {

// Shares of all voxels that a preset may show: of presets that suit 0.004 to 0.65 of real volumes;
// what shows all of one is a block.
constexpr double kLeastShown = 2e-4;
constexpr double kMostShown = 0.97;

/// What rows go by.
struct Evidence {
  const Volume& volume;
  const Identity& identity;
  Histogram values;

  bool is_of(std::initializer_list<BodyRegion> regions) const {
    return std::ranges::find(regions, identity.region) != regions.end();
  }
  /// The automatic choice tells kinds of volumes apart.
  bool is_for(std::string_view preset) const { return identity.preset == preset; }
  double ml_above(float value) const {
    const Vec3& mm = volume.spacing;
    const double ml = double{mm.x} * mm.y * mm.z / 1000;
    return values.share_between(value, std::numeric_limits<float>::max()) * ml *
           static_cast<double>(volume.voxels());
  }
};

bool in_hu(const Evidence& e) { return e.identity.hu; }
bool has_contrast(const Evidence& e) { return e.identity.contrast; }
bool has_lungs(const Evidence& e) {
  return e.is_of({BodyRegion::kChest, BodyRegion::kTrunk, BodyRegion::kWhole});
}

/// Skin ends, and glass shows a body, against the air about it.
bool has_air(const Evidence& e) {
  constexpr float kAir = -300;  // HU; fat has more
  return in_hu(e) && e.values.min < kAir;
}

/// Beyond what bone reaches: of real trunks without metal 0.002 and 0.02 ml, with it 0.8 and 15 ml.
/// Enamel and fillings of heads are left to `teeth`.
bool has_metal(const Evidence& e) {
  constexpr float kMetal = 1800;  // HU
  constexpr double kLeast = 0.1;  // ml
  return in_hu(e) && !e.is_for("teeth") &&
         !e.is_of({BodyRegion::kHead, BodyRegion::kTeeth, BodyRegion::kWhole}) &&
         e.ml_above(kMetal) >= kLeast;
}

struct PresetRow {
  const char* preset;
  bool (*fits)(const Evidence&);
};

constexpr PresetRow kPresetRows[] = {
    {"soft-tissue", in_hu},
    {"skin", has_air},
    {"skin-and-bone", in_hu},
    {"anatomy", has_air},
    {"muscle", in_hu},
    {"skeleton", in_hu},
    {"bone", in_hu},
    {"vessels", has_contrast},
    {"surgery", has_contrast},
    {"angiography", has_contrast},
    {"stent", has_metal},
    {"lung", has_lungs},
    {"teeth",
     [](const Evidence& e) {
       return e.is_of({BodyRegion::kHead, BodyRegion::kTeeth, BodyRegion::kWhole});
     }},
    {"x-ray", has_air},
    {"glass", has_air},
    {"crystal", has_air},
    {"mr", [](const Evidence& e) { return e.is_for("mra"); }},
    {"brain", [](const Evidence& e) { return e.is_for("mr"); }},
    {"generic",
     [](const Evidence& e) { return !in_hu(e) && !e.is_for("photo") && !e.is_for("mra"); }}};

/// Share of the voxels that the transfer function shows, 0…1.
double shown_share(const Evidence& e, const TransferFunction& transfer) {
  constexpr float kVeil = 0.02f;  // 1/mm; two thirds of the light pass 2 cm of it
  const Histogram& values = e.values;
  double shown = 0;
  for (int bin = 0; bin < Histogram::kBins; ++bin) {
    const float value = values.min + (static_cast<float>(bin) + 0.5f) * values.bin_width();
    shown += transfer.at(value).extinction > kVeil ? static_cast<double>(values.counts[bin]) : 0;
  }
  return shown / static_cast<double>(e.volume.voxels());
}

}  // namespace

std::vector<std::string> suitable_presets(const Volume& volume, const Identity& identity) {
  const Evidence evidence{volume, identity, histogram(volume)};
  std::vector<std::string> presets = {identity.preset};
  for (const PresetRow& row : kPresetRows) {
    if (row.preset == identity.preset || !row.fits(evidence)) {
      continue;
    }
    const double shown = shown_share(evidence, load_preset(row.preset, volume).transfer);
    if (shown >= kLeastShown && shown <= kMostShown) {
      presets.emplace_back(row.preset);
    }
  }
  return presets;
}

}  // namespace clipgs
