#include "volume/preset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "core/image.h"
#include "volume/phantom.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using testing::HasSubstr;

constexpr const char* kSmall = R"({
  "title": "Small", "modality": "ct", "units": "hu", "surface_strength": 0.5, "exposure": 2,
  "phase_g": 0.6,
  "points": [{"value": 0, "color": "#000000", "extinction": 0},
             {"value": 100, "color": [1, 0.5, 0], "extinction": 2, "specular": 0.2, "roughness": 0.3,
              "phase": -0.2}],
  "lights": {"sky": {"top": {"color": "#ffffff", "intensity": 0.5},
                     "horizon": {"color": "#ffffff"}, "bottom": {"color": "#000000"}},
             "keys": [{"direction": [0, 2, 0], "color": "#ffffff", "intensity": 3,
                       "angular_radius_deg": 10}]}})";

std::string with(std::string from, const std::string& to) {
  std::string text = kSmall;
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, from.size(), to);
}

std::string parse_error(const std::string& json) {
  return error_of([&] { parse_preset(json, "small", "small.json"); });
}

TEST(Preset, ReadsEveryKey) {
  const Preset preset = parse_preset(kSmall, "small", "here");
  EXPECT_EQ(preset.name, "small");
  EXPECT_EQ(preset.title, "Small");
  EXPECT_EQ(preset.modality, Modality::kCt);
  EXPECT_EQ(preset.surface_strength, 0.5f);
  EXPECT_EQ(preset.exposure, 2);
  const Material& m = preset.transfer.at(100);
  EXPECT_NEAR(m.albedo.g, linear_from_srgb(0.5f), 1e-6f);
  EXPECT_EQ(m.extinction, 2);
  EXPECT_EQ(m.specular, 0.2f);
  EXPECT_EQ(m.roughness, 0.3f);
  EXPECT_EQ(m.phase, -0.2f);
  EXPECT_EQ(preset.transfer.at(0).phase, 0.6f);  // the preset's
  EXPECT_EQ(preset.rig.sky_top, Vec3(0.5f));
  EXPECT_EQ(preset.rig.sky_horizon, Vec3(1));
  ASSERT_EQ(preset.rig.keys.size(), 1);
  EXPECT_EQ(preset.rig.keys[0].direction, Vec3(0, 1, 0));
  EXPECT_EQ(preset.rig.keys[0].radiance, Vec3(3));
  EXPECT_NEAR(preset.rig.keys[0].angular_radius, 0.174533f, 1e-5f);
}

TEST(Preset, ReadsGradientOpacity) {
  EXPECT_FALSE(parse_preset(kSmall, "small", "here").gradient_opacity);
  const auto text = [](const std::string& value) {
    return with("\"exposure\": 2", "\"exposure\": 2, \"gradient_opacity\": " + value);
  };
  const Preset preset = parse_preset(text(R"({"from": 20, "to": 60, "floor": 0.2})"), "s", "here");
  const GradientOpacity g = preset.gradient_opacity.value();
  EXPECT_FLOAT_EQ(g.factor(0), 0.2f);
  EXPECT_FLOAT_EQ(g.factor(20), 0.2f);
  EXPECT_FLOAT_EQ(g.factor(40), 0.6f);
  EXPECT_FLOAT_EQ(g.factor(1000), 1);
  EXPECT_EQ(parse_preset(text(R"({"from": 0, "to": 1})"), "s", "s").gradient_opacity->floor, 0);
  for (const char* const wrong : {R"({"from": 60, "to": 60})", R"({"from": -1, "to": 60})",
                                  R"({"from": 0, "to": 60, "floor": 1.1})"}) {
    EXPECT_THAT(parse_error(text(wrong)), HasSubstr("gradient_opacity: needs 0 <= from < to"));
  }
  EXPECT_THAT(parse_error(text(R"({"from": 20})")), HasSubstr("\"to\" is missing"));
  EXPECT_THAT(parse_error(text("[20, 60]")), HasSubstr("gradient_opacity: expected an object"));
  EXPECT_THAT(parse_error(text(R"({"from": 0, "to": 1, "flor": 0})")), HasSubstr("\"flor\""));
}

TEST(LightRig, BuiltInOnesLightAWhiteFaceFromEverySide) {
  const std::vector<std::string> names = rig_names();
  EXPECT_THAT(names,
              testing::ElementsAre("ambient", "dome", "rim", "softbox", "studio", "theatre"));
  for (const std::string& name : names) {
    const LightRig rig = load_rig(name);
    // No side of a cut is black: the sky alone shows it.
    for (const Vec3& sky : {rig.sky_top, rig.sky_horizon, rig.sky_bottom}) {
      EXPECT_GT(glm::min(sky.r, glm::min(sky.g, sky.b)), 0.1f) << name;
    }
  }
  EXPECT_TRUE(load_rig("ambient").keys.empty());
}

TEST(LightRig, PresetsNameOneOrHoldOne) {
  std::string text = kSmall;
  const size_t lights = text.find("\"lights\"");
  const Preset named =
      parse_preset(text.substr(0, lights) + "\"lights\": \"rim\"}", "small", "small.json");
  EXPECT_EQ(named.rig.keys.size(), load_rig("rim").keys.size());
  const TestFolder folder;
  write_text(folder / "mine.json", text.substr(lights + 10, text.size() - lights - 11));
  const LightRig own = load_rig((folder / "mine.json").string());
  EXPECT_EQ(own.keys.size(), 1);
  EXPECT_THAT(error_of([] { load_rig("disco"); }),
              testing::AllOf(HasSubstr("disco"), HasSubstr("studio")));
  EXPECT_THAT(parse_error(text.substr(0, lights) + "\"lights\": \"disco\"}"), HasSubstr("disco"));
}

TEST(Preset, ErrorsSayWhereAndWhat) {
  EXPECT_THAT(parse_error("{"), HasSubstr("small.json: not JSON"));
  EXPECT_THAT(parse_error("[]"), HasSubstr("expected an object"));
  EXPECT_THAT(parse_error(with("\"extinction\": 2", "\"extinction\": -2")),
              HasSubstr("extinction at value 100"));
  EXPECT_THAT(parse_error(with("\"extinction\": 2", "\"extinctoin\": 2")),
              HasSubstr("point 2: \"extinction\" is missing"));
  EXPECT_THAT(parse_error(with("\"specular\"", "\"shine\"")), HasSubstr("unknown key \"shine\""));
  EXPECT_THAT(parse_error(with("#000000", "black")), HasSubstr("point 1: \"color\""));
  EXPECT_THAT(parse_error(with("[1, 0.5, 0]", "[1, 2, 0]")), HasSubstr("0..1"));
  EXPECT_THAT(parse_error(with("[0, 2, 0]", "[0, 0, 0]")), HasSubstr("direction"));
  EXPECT_THAT(parse_error(with("\"ct\"", "\"pet\"")), HasSubstr("modality"));
  EXPECT_THAT(parse_error(with("\"hu\"", "\"lumens\"")), HasSubstr("units"));
  EXPECT_THAT(parse_error(with("\"exposure\": 2", "\"exposure\": 0")), HasSubstr("exposure"));
  EXPECT_THAT(parse_error(with("\"phase\": -0.2", "\"phase\": -1")),
              HasSubstr("phase at value 100"));
  EXPECT_THAT(parse_error(with("\"phase_g\": 0.6", "\"phase_g\": 1")), HasSubstr("phase_g"));
}

TEST(Preset, EveryBuiltInParsesAndLetsAirThrough) {
  const std::vector<std::string> names = preset_names();
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  for (const char* name : {"bone", "generic", "lung", "mr", "muscle", "photo", "skin-and-bone",
                           "soft-tissue", "vessels"}) {
    EXPECT_THAT(names, testing::Contains(name));
  }
  for (const std::string& name : names) {
    const Preset preset = load_preset(name);
    EXPECT_FALSE(preset.title.empty()) << name;
    EXPECT_FALSE(preset.description.empty()) << name;
    EXPECT_FALSE(preset.rig.keys.empty()) << name;
    const float lowest = preset.transfer.min_value();
    EXPECT_EQ(preset.transfer.at(lowest).extinction, 0) << name;
    EXPECT_GT(preset.transfer.max_extinction(lowest, 1e9f), 0.1f) << name;
  }
}

TEST(Preset, UnknownNameListsThePresets) {
  const std::string error = error_of([] { load_preset("bones"); });
  EXPECT_THAT(error, HasSubstr("bones"));
  EXPECT_THAT(error, HasSubstr("skin-and-bone"));
}

TEST(Preset, LoadsAFileByPath) {
  const TestFolder folder;
  std::ofstream(folder / "mine.json") << kSmall;
  EXPECT_EQ(load_preset((folder / "mine.json").string()).name, "mine");
}

Volume with_values(float scale, float offset, Modality modality) {
  Volume volume = make_ball(24, 8, 1, 0);
  volume.values.transform([&](float value) { return value * scale + offset; });
  volume.modality = modality;
  return volume;
}

TEST(Preset, AutoFollowsTheModality) {
  EXPECT_EQ(choose_preset(make_phantom(32)).name, "soft-tissue");
  EXPECT_EQ(choose_preset(with_values(900, 0, Modality::kMr)).name, "mr");
  EXPECT_EQ(choose_preset(with_values(200, 0, Modality::kUnknown)).name, "generic");
  EXPECT_EQ(choose_preset(with_values(255, 0, Modality::kPhoto)).name, "photo");
  EXPECT_EQ(choose_preset(with_values(1500, 0, Modality::kCt)).name, "vessels");
  EXPECT_EQ(load_preset("auto", make_phantom(32)).name, "soft-tissue");
}

// The look must not depend on the unit that a scanner happened to store.
TEST(Preset, PercentilesFollowTheScanner) {
  const Volume small = with_values(200, 0, Modality::kMr);
  const Volume large = with_values(20000, 300, Modality::kMr);
  const Preset a = load_preset("mr", small);
  const Preset b = load_preset("mr", large);
  EXPECT_EQ(a.units, ValueUnits::kStored);
  for (const float share : {0.1f, 0.6f, 0.9f, 1.0f}) {
    EXPECT_NEAR(a.transfer.at(200 * share).extinction,
                b.transfer.at(20000 * share + 300).extinction, 0.02f);
  }
  EXPECT_NEAR(a.surface_strength * 200, b.surface_strength * 20000, 0.1f);
  EXPECT_EQ(a.transfer.at(0).extinction, 0);
  EXPECT_EQ(b.transfer.at(300).extinction, 0);
}

TEST(Preset, GradientOpacityFollowsTheScanner) {
  Preset preset = load_preset("mr");
  preset.gradient_opacity = GradientOpacity{0.1f, 0.4f, 0.3f};
  Preset tenfold = preset;
  resolve_percentiles(preset, with_values(200, 0, Modality::kMr));
  resolve_percentiles(tenfold, with_values(2000, 300, Modality::kMr));
  EXPECT_GT(preset.gradient_opacity->from, 1);
  EXPECT_FLOAT_EQ(preset.gradient_opacity->to, 4 * preset.gradient_opacity->from);
  EXPECT_EQ(preset.gradient_opacity->floor, 0.3f);
  EXPECT_NEAR(tenfold.gradient_opacity->to, 10 * preset.gradient_opacity->to, 0.5f);
}

}  // namespace
}  // namespace clipgs
