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
#include "volume/test_bodies.h"
#include "volume/test_ct.h"
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
/// Without bone, so that nothing tells the region.
const std::vector<Part> kTissueParts = {{0.6f, -1015, -985}, {0.2f, -130, -80}, {0.2f, 10, 90}};

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

void expect_identified(const Expected& row) {
  const Identity identity = identify(row.volume);
  EXPECT_EQ(identity.what, row.what) << identity.reason;
  EXPECT_EQ(identity.preset, row.preset) << row.what;
  EXPECT_THAT(identity.reason, HasSubstr(row.reason));
}

Volume in_voxels_of(float spacing, Volume volume) {
  volume.spacing = Vec3(spacing);
  return volume;
}

Volume with_hints(Volume volume, void (*hint)(Hints&)) {
  hint(volume.hints);
  return volume;
}

const std::vector<Part> kMrParts = {{0.4f, 0, 30}, {0.6f, 200, 900}};
const std::vector<Part> kLittle = {{0.992f, 0, 0}, {0.008f, 100, 250}};

float cut_off(float hu) { return std::max(hu, 0.0f); }
float eight_bit(float hu) { return std::floor((hu + 1024) / 16); }

TEST(Identify, RowsThatGoByTheModality) {
  const auto angiography = [](Hints& hints) { hints.angiography = true; };
  const Expected rows[] = {
      {mixture(kMrParts, Modality::kPhoto), "photographs", "photo", "colours"},
      {mixture(kMrParts, Modality::kPet), "PET", "pet", "says PET"},
      {mixture(kMrParts, Modality::kUltrasound), "ultrasound", "ultrasound", "says ultrasound"},
      {with_hints(mixture(kMrParts, Modality::kMr), angiography), "MR angiography", "mra",
       "and angiography"},
      {mixture(kLittle, Modality::kMr), "MR angiography", "mra", "only 0."},
      {mixture(kCtParts, Modality::kMr), "MR", "mr", "says MR"},
      {in_voxels_of(0.05f, mixture(kCtParts, Modality::kCt)), "micro-CT", "micro-ct", "0.05 mm"},
      {with_hints(mixture(kCtParts, Modality::kCt),
                  [](Hints& hints) { hints.region = BodyRegion::kTeeth; }),
       "CT of teeth or jaws", "teeth", "teeth or jaws"},
      {mixture(kCtParts, Modality::kCt, cut_off), "CT angiography", "vessels", "lies below 0 HU"},
      {with_hints(mixture(kCtParts, Modality::kCt), angiography), "CT angiography", "vessels",
       "header says CT, and angiography"},
  };
  for (const Expected& row : rows) {
    expect_identified(row);
  }
}

TEST(Identify, RowsOfWhatACtShows) {
  const Expected rows[] = {
      {ct_of(wrist_hu, Vec3(70), 0.5f), "cone-beam CT", "teeth", "cubes of 0.5 mm"},
      {ct_of(arterial_hu, kTrunkSize), "CT angiography", "vessels", "vessels full of contrast"},
      {ct_of(whole_hu, kWholeSize), "whole-body CT", "soft-tissue", "show a skull"},
      {ct_of(head_hu, kHeadSize), "head CT", "skin-and-bone", "150 show a skull"},
      {ct_of(chest_and_abdomen_hu, kTallSize), "CT of chest and abdomen", "soft-tissue",
       "240 lungs, 240 other trunk"},
      {ct_of(chest_hu, kTrunkSize), "chest CT", "soft-tissue", "300 lungs"},
      {ct_of(trunk_hu, kTrunkSize), "CT of abdomen or pelvis", "soft-tissue", "300 other trunk"},
      {ct_of(venous_hu, kTrunkSize), "CT of abdomen or pelvis", "soft-tissue", "HU: contrast"},
      {with_hints(ct_of(trunk_hu, kTrunkSize), [](Hints& hints) { hints.contrast = true; }),
       "CT of abdomen or pelvis", "soft-tissue", "contrast was given"},
      {ct_of(limb_hu, kHeadSize), "CT of a limb or neck", "skin-and-bone", "0 lungs"},
      {with_hints(mixture(kTissueParts, Modality::kCt),
                  [](Hints& hints) { hints.region = BodyRegion::kHead; }),
       "head CT", "skin-and-bone", "header says so"},
      {mixture(kTissueParts, Modality::kCt), "CT", "soft-tissue", "say CT"},
  };
  for (const Expected& row : rows) {
    expect_identified(row);
  }
}

TEST(Identify, RowsOfValuesAlone) {
  const std::vector<Part> brain = {{0.7f, 0, 0}, {0.3f, 300, 1500}};
  const Volume bits = mixture(kCtParts, Modality::kUnknown, eight_bit);
  const Expected rows[] = {
      {mixture(kCtParts, Modality::kUnknown, cut_off), "CT angiography", "vessels", "cut off"},
      {in_voxels_of(0.1f, bits), "micro-CT", "micro-ct", "voxels of 0.1 mm"},
      {bits, "CT in other units", "generic", "--hu 16,-1024 would"},
      {in_voxels_of(3, mixture(kLittle, Modality::kUnknown)), "PET, or another image of hot spots",
       "pet", "only 0."},
      {in_voxels_of(0.6f, mixture(kLittle, Modality::kUnknown)), "MR angiography", "mra",
       "only 0."},
      {mixture(kMrParts, Modality::kUnknown), "MR", "mr", "spread as MR's are"},
      {mixture(brain, Modality::kUnknown), "MR", "mr", "spread as MR's are"},
  };
  for (const Expected& row : rows) {
    expect_identified(row);
  }
}

TEST(Identify, SuggestsWindows) {
  const Identity head = identify(ct_of(head_hu, kHeadSize));
  ASSERT_EQ(head.windows.size(), 3U);
  EXPECT_EQ(head.windows[0].name, "brain");
  EXPECT_EQ(head.windows[0].window.width, 80);
  EXPECT_EQ(identify(ct_of(chest_hu, kTrunkSize)).windows[1].name, "lung");

  const Volume mr = with_hints(mixture(kMrParts, Modality::kMr),
                               [](Hints& hints) { hints.shown = Vec2(100, 700); });
  const Identity shown = identify(mr);
  ASSERT_EQ(shown.windows.size(), 2U);
  EXPECT_EQ(shown.windows[0].name, "header");
  EXPECT_EQ(shown.windows[0].window.center, 400);
  EXPECT_EQ(shown.windows[0].window.width, 600);
  EXPECT_EQ(shown.windows[1].name, "auto");
  const Window& most = shown.windows[1].window;
  EXPECT_NEAR(most.center + most.width / 2, 893, 5);
  EXPECT_GT(most.center - most.width / 2, 200);
  EXPECT_TRUE(identify(mixture(kMrParts, Modality::kPhoto)).windows.empty());
}

TEST(Identify, KnowsWhatWouldMakeHu) {
  const std::optional<Rescale> hu =
      likely_rescale(mixture(kCtParts, Modality::kUnknown, eight_bit));
  ASSERT_TRUE(hu);
  EXPECT_EQ(hu->scale, 16);
  EXPECT_EQ(hu->offset, -1024);
  const std::optional<Rescale> other =
      likely_rescale(mixture(kCtParts, Modality::kUnknown, [](float v) { return v / 6 + 300; }));
  ASSERT_TRUE(other);
  EXPECT_NEAR(other->scale, 6, 0.5f);
  EXPECT_NEAR(other->scale * (-1000.0f / 6 + 300) + other->offset, -1000, 60);
  EXPECT_FALSE(likely_rescale(mixture(kMrParts, Modality::kUnknown)));
  EXPECT_FALSE(likely_rescale(mixture(kCtParts, Modality::kCt)));
}

TEST(RealData, IsIdentified) {
  const std::filesystem::path data = data_folder();
  if (!std::filesystem::exists(data / "stent.nrrd")) {
    GTEST_SKIP() << "no real volumes at " << data;
  }
  for (const auto& [file, what, preset] :
       {std::tuple{"chest.nrrd", "chest CT", "soft-tissue"},
        std::tuple{"abdomen_pelvis_3mm.nii.gz", "CT of abdomen or pelvis", "soft-tissue"},
        std::tuple{"stent.nrrd", "CT angiography", "vessels"},
        std::tuple{"head.nrrd", "CT in other units", "generic"},
        std::tuple{"Iguana.nii.gz", "micro-CT", "micro-ct"},
        std::tuple{"chris_t1.nii.gz", "MR", "mr"}, std::tuple{"spm152.nii.gz", "MR", "mr"},
        std::tuple{"chris_MRA.nii.gz", "MR angiography", "mra"}}) {
    const Identity identity = identify(load_volume(data / file));
    EXPECT_EQ(identity.what, what) << file << ": " << identity.reason;
    EXPECT_EQ(identity.preset, preset) << file;
    EXPECT_EQ(identity.doubt, "") << file;
  }
}

TEST(RealData, HeadAndContrastAreTold) {
  const std::filesystem::path data = data_folder();
  if (!std::filesystem::exists(data / "head.nrrd")) {
    GTEST_SKIP() << "no real volumes at " << data;
  }
  LoadOptions options;
  options.hu = Rescale{16, -1024};
  const Identity head = identify(load_volume(data / "head.nrrd", options));
  EXPECT_EQ(head.what, "head CT") << head.reason;
  EXPECT_EQ(head.preset, "skin-and-bone");
  EXPECT_EQ(head.windows.front().name, "brain");
  const Identity veins = identify(load_volume(data / "dicom" / "jpeg2000"));
  EXPECT_EQ(veins.what, "CT of abdomen or pelvis");
  EXPECT_THAT(veins.reason, HasSubstr("153 HU: contrast"));
}

TEST(Identify, PartsAreSeenInACtAlone) {
  EXPECT_EQ(seen_part(ct_of(head_hu, kHeadSize)), BodyPart::kHead);
  EXPECT_EQ(seen_part(ct_of(chest_hu, kTrunkSize)), BodyPart::kChest);
  EXPECT_EQ(seen_part(ct_of(trunk_hu, kTrunkSize)), BodyPart::kTrunk);  // or the pelvis alone
  EXPECT_EQ(seen_part(ct_of(whole_hu, kWholeSize)), BodyPart::kWholeBody);
  EXPECT_EQ(seen_part(ct_of(limb_hu, kHeadSize)), BodyPart::kUnknown);  // which one is not seen
  Volume mr = ct_of(head_hu, kHeadSize);
  mr.modality = Modality::kMr;
  EXPECT_EQ(seen_part(mr), BodyPart::kUnknown);
}

}  // namespace
}  // namespace clipgs
