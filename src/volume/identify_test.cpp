#include "volume/identify.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tuple>
#include <vector>

#include "core/random.h"
#include "volume/load.h"
#include "volume/phantom.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using ::testing::HasSubstr;

/// Of the voxels, a share whose values are spread evenly from `low` to `high`.
struct Part {
  float share;
  float low;
  float high;
};

/// Air, fat, soft tissue and bone of a CT, HU.
const std::vector<Part> kCtParts = {
    {0.6f, -1015, -985}, {0.2f, -130, -80}, {0.17f, 10, 90}, {0.03f, 200, 1700}};

/// Voxels of these values in any order.
Volume mixture(
    const std::vector<Part>& parts, Modality modality,
    float (*stored)(float) = [](float value) { return value; }) {
  Volume volume = make_ball(40, 10, 1, 0);
  volume.modality = modality;
  Rng rng(1);
  volume.values.transform([&](float) {
    float place = rng.uniform();
    auto part = parts.begin();
    while (place > part->share && part + 1 != parts.end()) {
      place -= part->share;
      ++part;
    }
    return stored(std::round(part->low + (part->high - part->low) * rng.uniform()));
  });
  return volume;
}

struct Expected {
  Volume volume;
  const char* what;
  const char* preset;
  const char* reason;
};

TEST(Identify, EveryRowOfTheTable) {
  const auto cut_off = [](float hu) { return std::max(hu, 0.0f); };
  const auto eight_bit = [](float hu) { return std::floor((hu + 1024) / 16); };
  const std::vector<Part> mr = {{0.4f, 0, 30}, {0.6f, 200, 900}};
  const std::vector<Part> brain = {{0.7f, 0, 0}, {0.3f, 300, 1500}};
  const std::vector<Part> vessels = {{0.992f, 0, 0}, {0.008f, 100, 250}};
  const Expected rows[] = {
      {mixture(mr, Modality::kPhoto), "photographs", "photo", "colours"},
      {mixture(kCtParts, Modality::kCt, cut_off), "CT angiography", "vessels", "lies below 0 HU"},
      {mixture(kCtParts, Modality::kCt), "CT", "soft-tissue", "say CT"},
      {mixture(kCtParts, Modality::kMr), "MR", "mr", "header says MR"},
      {mixture(kCtParts, Modality::kUnknown, cut_off), "CT angiography", "vessels", "cut off"},
      {mixture(kCtParts, Modality::kUnknown, eight_bit), "CT in other units", "generic", "--hu 16"},
      {mixture(vessels, Modality::kUnknown), "an image of little, as of vessels alone", "generic",
       "only 0."},
      {mixture(mr, Modality::kUnknown), "MR", "mr", "spread as MR's are"},
      {mixture(brain, Modality::kUnknown), "MR", "mr", "spread as MR's are"},
  };
  for (const Expected& row : rows) {
    const Identity identity = identify(row.volume);
    EXPECT_EQ(identity.what, row.what) << identity.reason;
    EXPECT_EQ(identity.preset, row.preset);
    EXPECT_THAT(identity.reason, HasSubstr(row.reason));
  }
}

TEST(RealData, IsIdentified) {
  const std::filesystem::path data = data_folder();
  if (!std::filesystem::exists(data / "stent.nrrd")) {
    GTEST_SKIP() << "no real volumes at " << data;
  }
  for (const auto& [file, what, preset] :
       {std::tuple{"chest.nrrd", "CT", "soft-tissue"},
        std::tuple{"abdomen_pelvis_3mm.nii.gz", "CT", "soft-tissue"},
        std::tuple{"stent.nrrd", "CT angiography", "vessels"},
        std::tuple{"head.nrrd", "CT in other units", "generic"},
        std::tuple{"Iguana.nii.gz", "CT in other units", "generic"},
        std::tuple{"chris_t1.nii.gz", "MR", "mr"}, std::tuple{"spm152.nii.gz", "MR", "mr"},
        std::tuple{"chris_MRA.nii.gz", "an image of little, as of vessels alone", "generic"}}) {
    const Identity identity = identify(load_volume(data / file));
    EXPECT_EQ(identity.what, what) << file << ": " << identity.reason;
    EXPECT_EQ(identity.preset, preset) << file;
  }
}

}  // namespace
}  // namespace clipgs
