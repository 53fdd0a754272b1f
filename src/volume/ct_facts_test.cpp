#include "volume/ct_facts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "volume/test_ct.h"

namespace clipgs {
namespace {

using ::testing::HasSubstr;

TEST(CtFacts, RegionsByWhatSlicesShow) {
  struct Case {
    HuAt hu;
    Vec3 size;
    BodyRegion region;
  };
  for (const Case& one :
       {Case{whole_hu, kWholeSize, BodyRegion::kWhole}, Case{head_hu, kHeadSize, BodyRegion::kHead},
        Case{chest_and_abdomen_hu, kTallSize, BodyRegion::kTrunk},
        Case{chest_hu, kTrunkSize, BodyRegion::kChest},
        Case{trunk_hu, kTrunkSize, BodyRegion::kAbdomen},
        Case{limb_hu, kHeadSize, BodyRegion::kLimb}}) {
    const CtFacts facts = ct_facts(ct_of(one.hu, one.size));
    EXPECT_EQ(facts.region, one.region) << "skull " << facts.skull << " lungs " << facts.lungs;
    EXPECT_EQ(facts.doubt, "");
    EXPECT_NEAR(facts.height, one.size.z, 3);
  }
}

TEST(CtFacts, LengthsAreMillimetresWhateverTheVoxels) {
  for (const float spacing : {1.5f, 3.0f}) {
    const CtFacts facts = ct_facts(ct_of(head_hu, kHeadSize, spacing));
    EXPECT_NEAR(facts.skull, 150, 4) << spacing;
  }
}

TEST(CtFacts, ContrastIsNoBone) {
  const Contrast none = ct_facts(ct_of(trunk_hu, kTrunkSize)).contrast;
  EXPECT_FALSE(none.any()) << "the marrow of the spine: " << none.ml << " ml";
  const Contrast arterial = ct_facts(ct_of(arterial_hu, kTrunkSize)).contrast;
  EXPECT_TRUE(arterial.arterial());
  EXPECT_NEAR(arterial.hu, 340, 20);
  EXPECT_LT(arterial.ml, 3.14f * 1.3f * 1.3f * 30);  // edges are left out
  EXPECT_GT(arterial.ml, 50);
  const Contrast venous = ct_facts(ct_of(venous_hu, kTrunkSize)).contrast;
  EXPECT_TRUE(venous.any());
  EXPECT_FALSE(venous.arterial());
  EXPECT_NEAR(venous.hu, 160, 15);
}

TEST(CtFacts, ArteriesOfTheBrain) {
  EXPECT_FALSE(ct_facts(ct_of(head_hu, kHeadSize, 1)).contrast.any());
  const CtFacts facts = ct_facts(ct_of(head_angiography_hu, kHeadSize, 1));
  EXPECT_EQ(facts.region, BodyRegion::kHead);
  EXPECT_TRUE(facts.contrast.arterial()) << facts.contrast.ml << " ml, " << facts.contrast.hu;
}

TEST(CtFacts, DoubtsWhatLiesWhereItShouldNot) {
  const auto upside_down = [](HuAt hu, const Vec3& size) {
    static HuAt upright;
    upright = hu;
    return ct_of([](const Vec3& p) { return upright(p * Vec3(1, 1, -1)); }, size);
  };
  EXPECT_THAT(ct_facts(upside_down(head_hu, kHeadSize)).doubt, HasSubstr("upside down"));
  EXPECT_THAT(ct_facts(upside_down(whole_hu, kWholeSize)).doubt, HasSubstr("upside down"));
  EXPECT_THAT(ct_facts(upside_down(chest_and_abdomen_hu, kTallSize)).doubt,
              HasSubstr("lungs lie below"));
  const Volume turned =
      ct_of([](const Vec3& p) { return trunk_hu(p * Vec3(1, -1, 1)); }, kTrunkSize);
  EXPECT_THAT(ct_facts(turned).doubt, HasSubstr("front and back"));
}

}  // namespace
}  // namespace clipgs
