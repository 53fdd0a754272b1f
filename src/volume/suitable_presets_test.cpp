#include "volume/suitable_presets.h"

#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "volume/load.h"
#include "volume/test_ct.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using ::testing::ElementsAreArray;

/// A cube of metal of 0.7 ml.
bool in_implant(const Vec3& p) {
  const Vec3 distance = glm::abs(p - Vec3(40, 0, 40));
  return glm::max(glm::max(distance.x, distance.y), distance.z) < 4.5f;
}
float implant_hu(const Vec3& p) { return in_implant(p) ? 3000 : trunk_hu(p); }
float filling_hu(const Vec3& p) { return in_implant(p) ? 3000 : head_hu(p); }
float boneless_hu(const Vec3& p) { return std::min(trunk_hu(p), 50.0f); }

Volume of_modality(Modality modality, Volume volume) {
  volume.modality = modality;
  return volume;
}

Volume with_values(float (*stored)(float), Volume volume) {
  volume.values.transform(stored);
  return volume;
}

/// A hundredth of it is bright.
Volume little(Modality modality) {
  return with_values([](float hu) { return hu > 650 ? hu - 600 : 0; },
                     of_modality(modality, ct_of(trunk_hu, kTrunkSize)));
}

/// Of a CT with skin and bone; `special` ones come before those of light that passes through.
std::vector<std::string> trunk_looks(const std::vector<std::string>& special) {
  std::vector<std::string> looks = {"soft-tissue", "skin",     "skin-and-bone", "anatomy",
                                    "muscle",      "skeleton", "bone"};
  looks.insert(looks.end(), special.begin(), special.end());
  looks.insert(looks.end(), {"x-ray", "glass", "crystal"});
  return looks;
}

TEST(SuitablePresets, ARowEach) {
  const Volume trunk = ct_of(trunk_hu, kTrunkSize);
  Volume agent = trunk;
  agent.hints.contrast = true;
  Volume specimen = ct_of(wrist_hu, Vec3(70), 1);
  specimen.spacing = Vec3(0.05f);
  const struct {
    const char* what;
    Volume volume;
    std::vector<std::string> presets;
  } rows[] = {
      {"trunk", trunk, trunk_looks({})},
      {"without bone",
       ct_of(boneless_hu, kTrunkSize),
       {"soft-tissue", "skin", "skin-and-bone", "anatomy", "muscle", "crystal"}},
      {"arteries",
       ct_of(arterial_hu, kTrunkSize),
       {"vessels", "soft-tissue", "skin", "skin-and-bone", "anatomy", "muscle", "skeleton", "bone",
        "surgery", "angiography", "x-ray", "glass", "crystal"}},
      {"veins", ct_of(venous_hu, kTrunkSize), trunk_looks({"vessels", "surgery", "angiography"})},
      {"an agent", agent, trunk_looks({"vessels", "surgery", "angiography"})},
      {"metal", ct_of(implant_hu, kTrunkSize), trunk_looks({"stent"})},
      {"chest", ct_of(chest_hu, kTrunkSize), trunk_looks({"lung"})},
      {"whole body", ct_of(whole_hu, kWholeSize, 5), trunk_looks({"lung", "teeth"})},
      {"head with metal",
       ct_of(filling_hu, kHeadSize),
       {"skin-and-bone", "soft-tissue", "skin", "anatomy", "muscle", "skeleton", "bone", "teeth",
        "x-ray", "glass", "crystal"}},
      {"no air",
       with_values([](float hu) { return std::max(hu, 0.0f); },
                   of_modality(Modality::kUnknown, ct_of(arterial_hu, kTrunkSize))),
       {"vessels", "skeleton", "bone", "surgery", "angiography"}},
      {"other units",
       with_values([](float hu) { return std::floor((hu + 1024) / 16); },
                   of_modality(Modality::kUnknown, trunk)),
       {"generic"}},
      {"specimen", specimen, {"micro-ct", "generic"}},
      {"MR", of_modality(Modality::kMr, trunk), {"mr", "brain", "generic"}},
      {"MR angiography", little(Modality::kMr), {"mra", "mr"}},
      {"PET", of_modality(Modality::kPet, trunk), {"pet", "generic"}},
      {"ultrasound", of_modality(Modality::kUltrasound, trunk), {"ultrasound", "generic"}},
      {"photographs", of_modality(Modality::kPhoto, trunk), {"photo"}},
  };
  for (const auto& row : rows) {
    const Identity identity = identify(row.volume);
    EXPECT_THAT(suitable_presets(row.volume, identity), ElementsAreArray(row.presets))
        << row.what << ": " << identity.what;
  }
}

TEST(RealData, SuitablePresets) {
  const std::filesystem::path data = data_folder();
  if (!std::filesystem::exists(data / "stent.nrrd")) {
    GTEST_SKIP() << "no real volumes at " << data;
  }
  const struct {
    const char* file;
    std::vector<std::string> presets;
  } rows[] = {
      {"stent.nrrd", {"vessels", "skeleton", "bone", "surgery", "angiography", "stent"}},
      {"chest.nrrd", trunk_looks({"lung"})},
      // A hip of metal.
      {"abdomen_pelvis_3mm.nii.gz", trunk_looks({"stent"})},
  };
  for (const auto& row : rows) {
    const Volume volume = load_volume(data / row.file);
    EXPECT_THAT(suitable_presets(volume, identify(volume)), ElementsAreArray(row.presets))
        << row.file;
  }
}

}  // namespace
}  // namespace clipgs
