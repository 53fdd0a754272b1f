#include "volume/identify.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

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
};

ValueFacts facts_of(const Volume& volume) {
  constexpr float kOutliers = 0.999f;
  constexpr int kPlaces = 100;
  const Histogram values = histogram(volume);
  const float threshold = otsu_threshold(values);
  const float range = values.quantile(kOutliers, threshold) - values.min;
  const float beyond = values.max + values.bin_width();
  ValueFacts facts{values.min, values.max};
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

struct Row {
  const char* what;
  const char* preset;
  bool (*fits)(const Volume&, const ValueFacts&);
  std::string (*reason)(const ValueFacts&);
};

/// A CT without air or fat (values cut off at about 0, as viewers of angiographies store them) has
/// nothing to tell tissue from background: only contrast and bone can be shown.
constexpr float kAirMissing = -300;
/// Least that gathers in a CT: 0.78 to 0.87 in those tried; MR of heads 0.28 and 0.36.
constexpr float kGathered = 0.6f;

bool is_unknown(const Volume& volume) { return volume.modality == Modality::kUnknown; }

/// Where HU are cut off at zero, what is left is tissue just above it, and contrast, bone and metal
/// far beyond what eight bits hold. MR without its background has its tissue in the middle.
bool is_hu_cut_off(const ValueFacts& facts) {
  constexpr float kBeyondEightBits = 400;
  return facts.min >= 0 && facts.min < 1 && facts.max > kBeyondEightBits && facts.lowest > 0.5f &&
         facts.low > 0.5f;
}

/// Air at the lowest value and soft tissue where most gathers.
std::string scale_to_hu(const ValueFacts& facts) {
  constexpr float kAir = -1000;
  constexpr float kTissue = 30;
  const float scale = (kTissue - kAir) / (facts.gathered_at - facts.min);
  return fmt::format(
      "its values gather as CT's do, but are no HU; --hu {:.3g},{:.0f} would make "
      "such of them",
      scale, kAir - scale * facts.min);
}

const std::array kTable = {
    Row{"photographs", "photo",
        [](const Volume& v, const ValueFacts&) { return v.modality == Modality::kPhoto; },
        [](const ValueFacts&) { return std::string("it has colours"); }},
    Row{"CT angiography", "vessels",
        [](const Volume& v, const ValueFacts& facts) {
          return v.modality == Modality::kCt && facts.min > kAirMissing;
        },
        [](const ValueFacts& facts) {
          return fmt::format("CT without air or fat: nothing lies below {:.0f} HU", facts.min);
        }},
    Row{"CT", "soft-tissue",
        [](const Volume& v, const ValueFacts&) { return v.modality == Modality::kCt; },
        [](const ValueFacts&) {
          return std::string("its header, --hu or values as low as air's say CT");
        }},
    Row{"MR", "mr", [](const Volume& v, const ValueFacts&) { return v.modality == Modality::kMr; },
        [](const ValueFacts&) { return std::string("its header says MR"); }},
    Row{"CT angiography", "vessels",
        [](const Volume& v, const ValueFacts& facts) {
          return is_unknown(v) && is_hu_cut_off(facts);
        },
        [](const ValueFacts& facts) {
          return fmt::format("values from 0 to {:.0f}, most of them low: HU, cut off below water",
                             facts.max);
        }},
    Row{"CT in other units", "generic",
        [](const Volume& v, const ValueFacts& facts) {
          return is_unknown(v) && facts.gathered > kGathered;
        },
        scale_to_hu},
    Row{"an image of little, as of vessels alone", "generic",
        [](const Volume& v, const ValueFacts& facts) {
          return is_unknown(v) && facts.foreground < 0.03f;
        },
        [](const ValueFacts& facts) {
          return fmt::format("only {:.1f} % of it is no background", 100 * facts.foreground);
        }},
    Row{"MR", "mr", [](const Volume&, const ValueFacts&) { return true; },
        [](const ValueFacts& facts) {
          return fmt::format(
              "its values are spread as MR's are: no tenth of their range holds more "
              "than {:.0f} % of what is no background",
              100 * facts.gathered);
        }},
};

}  // namespace

Identity identify(const Volume& volume) {
  const ValueFacts facts = facts_of(volume);
  const auto* const row =
      std::ranges::find_if(kTable, [&](const Row& one) { return one.fits(volume, facts); });
  return {row->what, row->reason(facts), row->preset};
}

Preset choose_preset(const Volume& volume) { return load_preset(identify(volume).preset, volume); }

}  // namespace clipgs
