#include "volume/identify.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <string_view>

#include "volume/ct_facts.h"
#include "volume/histogram.h"
#include "volume/preset.h"

namespace clipgs {

namespace {

/// What values say without a unit.
struct ValueFacts {
  float min = 0;
  float max = 0;
  float lowest = 0;      ///< share of the voxels that have the lowest value
  float foreground = 0;  ///< share of them above Otsu's threshold
  float low = 0;  ///< of those above the lowest, the share in the lowest seventh of the range
  /// Of the foreground, the share in the tenth of the range that holds most of it, and the middle
  /// of that tenth. Soft tissue of a CT lies within a few HU of all that air, metal and bone span;
  /// MR spreads it.
  float gathered = 0;
  float gathered_at = 0;
  Window most{0, 1};  ///< from the 1st to the 99th percentile of the foreground
};

ValueFacts value_facts(const Volume& volume) {
  constexpr float kOutliers = 0.999f;
  constexpr int kPlaces = 100;
  const Histogram values = histogram(volume);
  const float threshold = otsu_threshold(values);
  const float range = values.quantile(kOutliers, threshold) - values.min;
  const float beyond = values.max + values.bin_width();
  ValueFacts facts{values.min, values.max};
  const float dark = values.quantile(0.01f, threshold);
  const float bright = values.quantile(0.99f, threshold);
  facts.most = {0.5f * (dark + bright), bright - dark};
  facts.lowest = values.share_between(values.min, values.min + range / (2 * kPlaces));
  facts.foreground = values.share_between(threshold, beyond);
  facts.low = values.share_between(values.min + range / (2 * kPlaces), values.min + range / 7) /
              std::max(1 - facts.lowest, 1e-6f);
  for (int place = 0; place < kPlaces && facts.foreground > 0; ++place) {
    const float low = values.min + range * static_cast<float>(place) / kPlaces;
    const float share =
        values.share_between(std::max(low, threshold), low + range / 10) / facts.foreground;
    if (share > facts.gathered) {
      facts.gathered = share;
      facts.gathered_at = low + range / 20;
    }
  }
  return facts;
}

/// All that rows go by.
struct Facts {
  const Volume& volume;
  ValueFacts values;
  std::optional<CtFacts> ct;  ///< of a CT in HU with air

  bool is(Modality modality) const { return volume.modality == modality; }
  bool is_unknown() const { return is(Modality::kUnknown); }
  const Hints& hints() const { return volume.hints; }
  /// What the voxels tell goes before the header, whose region people set by hand.
  BodyRegion region() const {
    return ct && ct->region != BodyRegion::kUnknown ? ct->region : hints().region;
  }
  float finest() const { return glm::min(glm::min(spacing().x, spacing().y), spacing().z); }
  float coarsest() const { return glm::max(glm::max(spacing().x, spacing().y), spacing().z); }
  const Vec3& spacing() const { return volume.spacing; }
};

/// A CT without air or fat (values cut off at about 0, as viewers of angiographies store them) has
/// nothing to tell tissue from background: only contrast and bone can be shown.
constexpr float kAirMissing = -300;
/// Least that gathers in a CT: 0.78 to 0.87 in those tried; MR of heads 0.28 and 0.36.
constexpr float kGathered = 0.6f;
/// mm; scanners of patients do not resolve that, those of specimens begin here.
constexpr float kMicro = 0.15f;

bool is_micro(const Facts& facts) { return facts.coarsest() < kMicro; }

/// Less than this is no background in images of vessels or hot spots alone.
bool is_little(const Facts& facts) { return facts.values.foreground < 0.03f; }

/// Where HU are cut off at zero, what is left is tissue just above it, and contrast, bone and metal
/// far beyond what eight bits hold. MR without its background has its tissue in the middle.
bool is_hu_cut_off(const ValueFacts& facts) {
  constexpr float kBeyondEightBits = 400;
  return facts.min >= 0 && facts.min < 1 && facts.max > kBeyondEightBits && facts.lowest > 0.5f &&
         facts.low > 0.5f;
}

bool gathers_without_unit(const Facts& facts) {
  return facts.is_unknown() && !is_hu_cut_off(facts.values) && facts.values.gathered > kGathered;
}

/// Cone-beam CT of teeth or joints: cubes of less than half a millimetre, of a part smaller than a
/// head, with much bone.
bool is_cone_beam(const Facts& facts) {
  constexpr float kFine = 0.5f;   // mm
  constexpr float kCube = 1.05f;  // longest side of a voxel over the shortest
  constexpr float kSmall = 200;   // mm
  constexpr float kBony = 0.08f;
  const Vec3 size = Vec3(facts.volume.dims) * facts.spacing();
  return facts.ct && facts.coarsest() <= kFine && facts.coarsest() <= kCube * facts.finest() &&
         glm::max(glm::max(size.x, size.y), size.z) <= kSmall && facts.ct->bone >= kBony &&
         facts.ct->region != BodyRegion::kHead;
}

/// Air at the lowest value and soft tissue where most gathers. Near a power of two it is that:
/// scanners store HU + 1024 in 12 bits, and who needs fewer leaves the lowest out.
Rescale scale_to_hu(const ValueFacts& facts) {
  constexpr float kAir = -1000;
  constexpr float kTissue = 30;
  constexpr float kNear = 0.1f;
  const float scale = (kTissue - kAir) / (facts.gathered_at - facts.min);
  const float power = std::exp2(std::round(std::log2(scale)));
  if (facts.min == 0 && std::abs(scale / power - 1) < kNear) {
    return {power, -1024};
  }
  return {scale, kAir - scale * facts.min};
}

std::string why_gathers(const Facts& facts) {
  const Rescale hu = scale_to_hu(facts.values);
  return fmt::format(
      "its values gather as CT's do, but are no HU; --hu {:.3g},{:.0f} would make such of them",
      hu.scale, hu.offset);
}

std::string why_little(const Facts& facts) {
  return fmt::format("only {:.1f} % of it is no background, in voxels of {:.2g} mm",
                     100 * facts.values.foreground, facts.coarsest());
}

std::string why_full_vessels(const Facts& facts) {
  return fmt::format("{:.0f} ml of even matter of about {:.0f} HU: vessels full of contrast",
                     facts.ct->contrast.ml, facts.ct->contrast.hu);
}

/// What a region is told by, and what is known of contrast.
std::string why_region(const Facts& facts) {
  std::string why = "its header says so";
  if (facts.ct && facts.ct->region != BodyRegion::kUnknown) {
    const CtFacts& ct = *facts.ct;
    why = fmt::format("of its {:.0f} mm, {:.0f} show a skull, {:.0f} lungs, {:.0f} other trunk",
                      ct.height, ct.skull, ct.lungs, ct.trunk);
  }
  if (facts.ct && facts.ct->contrast.any()) {
    why += fmt::format("; {:.0f} ml of even matter of about {:.0f} HU: contrast",
                       facts.ct->contrast.ml, facts.ct->contrast.hu);
  } else if (facts.hints().contrast) {
    why += "; contrast was given, its header says";
  }
  return why;
}

struct Row {
  const char* what;
  const char* preset;
  std::vector<const char*> windows;  ///< of kCtWindows; empty: by the values
  bool (*fits)(const Facts&);
  std::string (*reason)(const Facts&);
};

template <BodyRegion kRegion>
bool shows(const Facts& facts) {
  return facts.is(Modality::kCt) && facts.region() == kRegion;
}

const std::vector<Row>& table() {
  static const std::vector<Row> rows = {
      {"photographs",
       "photo",
       {},
       [](const Facts& f) { return f.is(Modality::kPhoto); },
       [](const Facts&) { return std::string("it has colours"); }},
      {"PET",
       "pet",
       {},
       [](const Facts& f) { return f.is(Modality::kPet); },
       [](const Facts&) { return std::string("its header or --modality says PET"); }},
      {"ultrasound",
       "ultrasound",
       {},
       [](const Facts& f) { return f.is(Modality::kUltrasound); },
       [](const Facts&) { return std::string("its header or --modality says ultrasound"); }},
      {"MR angiography",
       "mra",
       {},
       [](const Facts& f) { return f.is(Modality::kMr) && f.hints().angiography; },
       [](const Facts&) { return std::string("its header says MR, and angiography"); }},
      {"MR angiography",
       "mra",
       {},
       [](const Facts& f) { return f.is(Modality::kMr) && is_little(f); },
       why_little},
      {"MR",
       "mr",
       {},
       [](const Facts& f) { return f.is(Modality::kMr); },
       [](const Facts&) { return std::string("its header or --modality says MR"); }},
      {"micro-CT",
       "micro-ct",
       {},
       [](const Facts& f) { return f.is(Modality::kCt) && is_micro(f); },
       [](const Facts& f) { return fmt::format("CT in voxels of {:.2g} mm", f.coarsest()); }},
      {"CT of teeth or jaws",
       "teeth",
       {"bone", "soft-tissue"},
       [](const Facts& f) { return f.is(Modality::kCt) && f.hints().region == BodyRegion::kTeeth; },
       [](const Facts&) { return std::string("its header says CT, and teeth or jaws"); }},
      {"cone-beam CT",
       "teeth",
       {"bone", "soft-tissue"},
       is_cone_beam,
       [](const Facts& f) {
         return fmt::format("CT in cubes of {:.2g} mm of a small part, {:.0f} % of it bone",
                            f.coarsest(), 100 * f.ct->bone);
       }},
      {"CT angiography",
       "vessels",
       {"soft-tissue", "bone"},
       [](const Facts& f) { return f.is(Modality::kCt) && f.values.min > kAirMissing; },
       [](const Facts& f) {
         return fmt::format("CT without air or fat: nothing lies below {:.0f} HU", f.values.min);
       }},
      {"CT angiography",
       "vessels",
       {"soft-tissue", "bone"},
       [](const Facts& f) { return f.is(Modality::kCt) && f.hints().angiography; },
       [](const Facts&) { return std::string("its header says CT, and angiography"); }},
      {"CT angiography",
       "vessels",
       {"soft-tissue", "bone"},
       [](const Facts& f) { return f.ct && f.ct->contrast.arterial(); },
       why_full_vessels},
      {"whole-body CT",
       "soft-tissue",
       {"soft-tissue", "lung", "bone"},
       shows<BodyRegion::kWhole>,
       why_region},
      {"head CT",
       "skin-and-bone",
       {"brain", "bone", "soft-tissue"},
       shows<BodyRegion::kHead>,
       why_region},
      {"CT of chest and abdomen",
       "soft-tissue",
       {"soft-tissue", "lung", "bone"},
       shows<BodyRegion::kTrunk>,
       why_region},
      {"chest CT",
       "soft-tissue",
       {"soft-tissue", "lung", "bone"},
       shows<BodyRegion::kChest>,
       why_region},
      {"CT of abdomen or pelvis",
       "soft-tissue",
       {"soft-tissue", "bone"},
       shows<BodyRegion::kAbdomen>,
       why_region},
      {"CT of a limb or neck",
       "skin-and-bone",
       {"bone", "soft-tissue"},
       shows<BodyRegion::kLimb>,
       why_region},
      {"CT",
       "soft-tissue",
       {"soft-tissue", "bone", "lung", "brain"},
       [](const Facts& f) { return f.is(Modality::kCt); },
       [](const Facts&) {
         return std::string("its header, an option or values as low as air's say CT");
       }},
      {"CT angiography",
       "vessels",
       {"soft-tissue", "bone"},
       [](const Facts& f) { return f.is_unknown() && is_hu_cut_off(f.values); },
       [](const Facts& f) {
         return fmt::format("values from 0 to {:.0f}, most of them low: HU, cut off below water",
                            f.values.max);
       }},
      {"micro-CT",
       "micro-ct",
       {},
       [](const Facts& f) { return gathers_without_unit(f) && is_micro(f); },
       [](const Facts& f) {
         return fmt::format("its values gather as CT's do, in voxels of {:.2g} mm", f.coarsest());
       }},
      {"CT in other units", "generic", {}, gathers_without_unit, why_gathers},
      {"PET, or another image of hot spots",
       "pet",
       {},
       [](const Facts& f) {
         constexpr float kResolution = 1.5f;  // mm; PET does not resolve that, angiographies do
         return f.is_unknown() && is_little(f) && f.finest() > kResolution;
       },
       why_little},
      {"MR angiography",
       "mra",
       {},
       [](const Facts& f) { return f.is_unknown() && is_little(f); },
       why_little},
      {"MR",
       "mr",
       {},
       [](const Facts&) { return true; },
       [](const Facts& f) {
         return fmt::format(
             "its values are spread as MR's are: no tenth of their range holds more than {:.0f} % "
             "of what is no background",
             100 * f.values.gathered);
       }}};
  return rows;
}

Facts facts_of(const Volume& volume) {
  Facts facts{volume, value_facts(volume), std::nullopt};
  if (facts.is(Modality::kCt) && facts.values.min <= kAirMissing && !is_micro(facts)) {
    facts.ct = ct_facts(volume);
  }
  return facts;
}

/// Specimens in HU are looked at as those without: by what gathers.
bool is_hu(const Facts& facts) {
  return !is_micro(facts) &&
         (facts.is(Modality::kCt) || (facts.is_unknown() && is_hu_cut_off(facts.values)));
}

bool shows_contrast(const Facts& facts, std::string_view preset) {
  return is_hu(facts) && (preset == "vessels" || facts.hints().angiography ||
                          facts.hints().contrast || (facts.ct && facts.ct->contrast.any()));
}

std::vector<SuggestedWindow> suggested_windows(const Row& row, const Facts& facts) {
  std::vector<SuggestedWindow> windows;
  if (const std::optional<Vec2> shown = facts.hints().shown) {
    windows.push_back({"header", {0.5f * (shown->x + shown->y), shown->y - shown->x}});
  }
  for (const char* const name : row.windows) {
    const auto* const known = std::ranges::find_if(
        kCtWindows, [&](const NamedWindow& one) { return one.name == std::string_view(name); });
    windows.push_back({name, known->window});
  }
  if (row.windows.empty() && !facts.is(Modality::kPhoto)) {
    windows.push_back({"auto", facts.values.most});
  }
  return windows;
}

}  // namespace

Identity identify(const Volume& volume) {
  const Facts facts = facts_of(volume);
  const auto row = std::ranges::find_if(table(), [&](const Row& one) { return one.fits(facts); });
  return {row->what,
          row->reason(facts),
          row->preset,
          suggested_windows(*row, facts),
          is_hu(facts),
          is_hu(facts) ? facts.region() : BodyRegion::kUnknown,
          shows_contrast(facts, row->preset),
          facts.ct ? facts.ct->doubt : ""};
}

BodyPart seen_part(const Volume& volume) {
  const Facts facts = facts_of(volume);
  switch (facts.ct ? facts.ct->region : BodyRegion::kUnknown) {
    case BodyRegion::kHead:
      return BodyPart::kHead;
    case BodyRegion::kChest:
      return BodyPart::kChest;
    case BodyRegion::kAbdomen:  // or pelvis
    case BodyRegion::kTrunk:
      return BodyPart::kTrunk;
    case BodyRegion::kWhole:
      return BodyPart::kWholeBody;
    default:  // any limb, or a neck
      return BodyPart::kUnknown;
  }
}

std::optional<Rescale> likely_rescale(const Volume& volume) {
  if (volume.modality != Modality::kUnknown) {
    return std::nullopt;
  }
  const Facts facts = facts_of(volume);
  return gathers_without_unit(facts) && !is_micro(facts) ? std::optional(scale_to_hu(facts.values))
                                                         : std::nullopt;
}

Preset choose_preset(const Volume& volume) { return load_preset(identify(volume).preset, volume); }

}  // namespace clipgs
