#include "core/volume_look.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"

namespace clipgs {
namespace {

TEST(VolumeLook, IsReadAsItWasWritten) {
  const VolumeLook look = make_volume_look(std::string(64, 'a'), "Haut", "Haut über Knochen.");
  EXPECT_EQ(look.volume, std::string(16, 'a'));
  const nlohmann::json object = {{kLookKey, volume_look_json(look)}};
  EXPECT_EQ(read_volume_look(JsonReader(object, "x")), look);
}

TEST(VolumeLook, IsEmptyWhereNoneIsSaid) {
  for (const nlohmann::json& object :
       {nlohmann::json{{"title", "x"}}, nlohmann::json{{kLookKey, volume_look_json({})}}}) {
    EXPECT_EQ(read_volume_look(JsonReader(object, "x")), VolumeLook());
  }
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
