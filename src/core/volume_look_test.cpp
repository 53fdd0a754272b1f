#include "core/volume_look.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"

namespace clipgs {
namespace {

TEST(VolumeLook, IsReadAsItWasWritten) {
  VolumeLook look = make_volume_look(std::string(64, 'a'), "Haut", "Haut über Knochen.");
  look.modality = Modality::kMr;
  look.part = BodyPart::kWholeBody;
  look.defaced = Defaced{272.1f, 5};
  EXPECT_EQ(look.volume, std::string(16, 'a'));
  const nlohmann::json object = {{kLookKey, volume_look_json(look)}};
  EXPECT_EQ(read_volume_look(JsonReader(object, "x")), look);
}

TEST(VolumeLook, WhatWentWithTheFaceIsChecked) {
  for (const nlohmann::json& defaced : {nlohmann::json(true), nlohmann::json{{"removed_ml", 3}},
                                        nlohmann::json{{"removed_ml", -3}, {"brain_mm", 5}},
                                        nlohmann::json{{"removed_ml", 3}, {"brain_mm", "far"}}}) {
    const nlohmann::json look = {
        {"volume", "aa"}, {"title", ""}, {"description", ""}, {"defaced", defaced}};
    const nlohmann::json object = {{kLookKey, look}};
    EXPECT_THROW(read_volume_look(JsonReader(object, "x")), Error) << defaced;
  }
}

TEST(VolumeLook, IsEmptyWhereNoneIsSaid) {
  for (const nlohmann::json& object :
       {nlohmann::json{{"title", "x"}}, nlohmann::json{{kLookKey, volume_look_json({})}}}) {
    EXPECT_EQ(read_volume_look(JsonReader(object, "x")), VolumeLook());
  }
}

TEST(VolumeLook, WordsThatAreNotKnownSayNothing) {
  const nlohmann::json look = {{"volume", "aa"},
                               {"title", "Haut"},
                               {"description", ""},
                               {"modality", "OCT"},
                               {"region", "Miller"}};
  const nlohmann::json object = {{kLookKey, look}};
  EXPECT_EQ(read_volume_look(JsonReader(object, "x")), (VolumeLook{"aa", "Haut", ""}));
}

TEST(VolumeLook, UsualTitlesSayWhatIsShownAndHow) {
  struct Row {
    BodyPart part;
    Modality modality;
    const char* look;
    const char* title;
  };
  for (const Row& row :
       {Row{BodyPart::kHead, Modality::kCt, "Skin and bone", "Head, skin and bone"},
        Row{BodyPart::kWholeBody, Modality::kPet, "PET (hot metal)", "Whole body, PET (hot metal)"},
        Row{BodyPart::kUnknown, Modality::kCt, "Skin and bone", "CT, skin and bone"},
        Row{BodyPart::kUnknown, Modality::kCt, "X-ray", "CT, X-ray"},
        Row{BodyPart::kUnknown, Modality::kUnknown, "Any scan", "Volume, any scan"},
        Row{BodyPart::kUnknown, Modality::kMr, "MR", "MR volume"},
        Row{BodyPart::kUnknown, Modality::kPet, "PET (hot metal)", "PET volume (hot metal)"},
        Row{BodyPart::kUnknown, Modality::kPhoto, "Photographs", "Photographic volume"},
        Row{BodyPart::kKnee, Modality::kMr, "", "Knee, surgery"}}) {
    EXPECT_EQ(usual_title({"", row.look, "", row.modality, row.part}, "surgery"), row.title);
  }
  EXPECT_EQ(usual_title({}, ""), "Volume");
}

TEST(VolumeLook, LongTextsEndAfterAWholeCharacter) {
  const std::string umlaut = "ü";  // two bytes
  std::string text = "x";
  for (int i = 0; i < 200; ++i) {
    text += umlaut;
  }
  const VolumeLook look = make_volume_look("0123456789abcdef", text, "");
  EXPECT_EQ(look.title, text.substr(0, 255));
  const nlohmann::json object = {{kLookKey, volume_look_json(look)}};
  EXPECT_EQ(read_volume_look(JsonReader(object, "x")), look);
}

TEST(VolumeLook, WhatIsNoneIsRefused) {
  for (const nlohmann::json& look :
       {nlohmann::json(7), nlohmann::json{{"volume", "x"}},
        nlohmann::json{{"volume", 7}, {"title", ""}, {"description", ""}}}) {
    const nlohmann::json object = {{kLookKey, look}};
    EXPECT_THAT([&] { read_volume_look(JsonReader(object, "a.sog")); },
                ::testing::ThrowsMessage<Error>(::testing::HasSubstr("a.sog")));
  }
}

}  // namespace
}  // namespace clipgs
