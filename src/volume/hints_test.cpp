#include "volume/hints.h"

#include <gtest/gtest.h>

#include "core/modality.h"

namespace clipgs {
namespace {

TEST(Modality, WordsAndNamesAreThoseOfOptionsAndCases) {
  EXPECT_EQ(modality_words(), "ct, mr, photo, pet, us");
  for (const Modality modality : kModalities) {
    EXPECT_EQ(modality_name(modality) == std::string("unknown"), modality == Modality::kUnknown);
  }
  EXPECT_EQ(modality_of_word("us"), Modality::kUltrasound);
  EXPECT_EQ(modality_name(Modality::kPet), std::string("PET"));
  EXPECT_EQ(modality_of_word("CT"), std::nullopt);
  EXPECT_EQ(modality_of_word("any"), std::nullopt);
}

TEST(Hints, ModalityByAnyoneOfItsTerms) {
  struct Case {
    const char* text;
    Modality modality;
  };
  for (const Case& one :
       {Case{"CT", Modality::kCt}, Case{"MET_MOD_CT", Modality::kCt}, Case{" MR ", Modality::kMr},
        Case{"MET_MOD_MR", Modality::kMr}, Case{"T1 mri", Modality::kMr},
        Case{"TE=2.9;Time=101010.100;phase=1", Modality::kMr}, Case{"PT", Modality::kPet},
        Case{"MET_MOD_PET", Modality::kPet}, Case{"US", Modality::kUltrasound},
        Case{"MET_MOD_US", Modality::kUltrasound}, Case{"OT", Modality::kUnknown},
        Case{"", Modality::kUnknown}, Case{"ctrl", Modality::kUnknown},
        Case{"spm - algebra", Modality::kUnknown}}) {
    Hints hints;
    hints.learn_modality(one.text);
    EXPECT_EQ(hints.modality, one.modality) << one.text;
  }
}

TEST(Hints, RegionsAndAngiographyByWords) {
  struct Case {
    const char* text;
    BodyRegion region;
    bool angiography;
  };
  for (const Case& one :
       {Case{"HEAD", BodyRegion::kHead, false}, Case{"Brain^Routine", BodyRegion::kHead, false},
        Case{"CTA HEADNECK 0.75", BodyRegion::kHead, true},
        Case{"tof_fl3d_tra", BodyRegion::kUnknown, true}, Case{"MRA", BodyRegion::kUnknown, true},
        Case{"Angiography abdominal aorta", BodyRegion::kAbdomen, true},
        Case{"DentalCT", BodyRegion::kTeeth, false}, Case{"CBCT", BodyRegion::kTeeth, false},
        Case{"Thorax 1.0 B70f", BodyRegion::kChest, false}, Case{"HAND", BodyRegion::kLimb, false},
        Case{"handled", BodyRegion::kUnknown, false}, Case{"CTAX", BodyRegion::kUnknown, false},
        Case{"", BodyRegion::kUnknown, false}}) {
    Hints hints;
    hints.learn_words(one.text);
    EXPECT_EQ(hints.region, one.region) << one.text;
    EXPECT_EQ(hints.angiography, one.angiography) << one.text;
  }
}

TEST(Hints, WhatIsKnownStays) {
  Hints hints;
  hints.learn_modality("CT");
  hints.learn_modality("MR");
  EXPECT_EQ(hints.modality, Modality::kCt);
  hints.learn_words("CTA CHEST");
  hints.learn_words("HEAD");
  EXPECT_EQ(hints.region, BodyRegion::kChest);
  EXPECT_TRUE(hints.angiography);
}

TEST(Hints, AnAgentIsNoneWhereItSaysSo) {
  Hints hints;
  for (const char* const none : {"", " ", "NONE", "no", "Without contrast"}) {
    hints.learn_agent(none);
    EXPECT_FALSE(hints.contrast) << none;
  }
  hints.learn_agent("Iohexol 350");
  EXPECT_TRUE(hints.contrast);
}

}  // namespace
}  // namespace clipgs
