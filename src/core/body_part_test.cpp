#include "core/body_part.h"

#include <gtest/gtest.h>

namespace clipgs {
namespace {

TEST(BodyPart, EveryNameStandsForItsPart) {
  for (size_t i = 1; i < kBodyPartNames.size(); ++i) {
    const auto part = static_cast<BodyPart>(i);
    EXPECT_EQ(body_part_of_term(body_part_name(part)), part) << body_part_name(part);
  }
  EXPECT_EQ(static_cast<size_t>(BodyPart::kWholeBody) + 1, kBodyPartNames.size());
  EXPECT_TRUE(body_part_words().starts_with("head, jaw, head and neck, "));
}

TEST(BodyPart, DicomsTermsStandForOne) {
  struct Case {
    const char* term;
    BodyPart part;
  };
  for (const Case& one :
       {Case{"HEAD", BodyPart::kHead}, Case{"BRAIN ", BodyPart::kHead},
        Case{"HEADNECK", BodyPart::kHeadAndNeck}, Case{"HEAD AND NECK", BodyPart::kHeadAndNeck},
        Case{"thorax", BodyPart::kChest}, Case{"LSPINE", BodyPart::kSpine},
        Case{"L-Spine", BodyPart::kSpine}, Case{"WHOLEBODY", BodyPart::kWholeBody},
        Case{"ABDOMENPELVIS", BodyPart::kTrunk}, Case{"ANKLE", BodyPart::kFoot}}) {
    EXPECT_EQ(body_part_of_term(one.term), one.part) << one.term;
  }
}

TEST(BodyPart, WhatMayNameAPersonStandsForNone) {
  for (const char* const text : {"", " ", "12", "HEAD MILLER", "Miller", "CHESTER", "EXTREMITY"}) {
    EXPECT_EQ(body_part_of_term(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace clipgs
