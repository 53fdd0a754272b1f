#include "volume/preset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "core/error.h"
#include "core/file.h"
#include "core/image.h"
#include "core/random.h"
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
  EXPECT_EQ(preset.tone, ToneCurve::kSrgb);
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
    EXPECT_THAT(parse_error(text(wrong)), HasSubstr("small.json: gradient_opacity."));
  }
  EXPECT_THAT(parse_error(text(R"({"from": 20})")), HasSubstr("gradient_opacity.to is missing"));
  EXPECT_THAT(parse_error(text("[20, 60]")), HasSubstr("gradient_opacity: expected an object"));
  EXPECT_THAT(parse_error(text(R"({"from": 0, "to": 1, "flor": 0})")), HasSubstr("\"flor\""));
}

TEST(Preset, ReadsABoundarysLook) {
  EXPECT_FALSE(parse_preset(kSmall, "small", "here").boundary);
  const auto text = [](const std::string& value) {
    return with("\"exposure\": 2", "\"exposure\": 2, \"boundary\": " + value);
  };
  const Preset preset =
      parse_preset(text(R"({"from": 20, "to": 60, "points": [{"value": 0, "color": "#ffffff"},
               {"value": 100, "color": "#000000", "specular": 0.8, "roughness": 0.1}]})"),
                   "s", "here");
  const BoundaryLook& look = preset.boundary.value();
  EXPECT_EQ(look.range.share(0), 0);
  EXPECT_EQ(look.range.share(20), 0);
  EXPECT_FLOAT_EQ(look.range.share(50), 0.75f);
  EXPECT_EQ(look.range.share(1000), 1);
  const Material plain = preset.transfer.at(100);
  const Material mixed = look.mixed(plain, 100, 0.5f);
  EXPECT_FLOAT_EQ(mixed.albedo.r, 0.5f * plain.albedo.r);
  EXPECT_FLOAT_EQ(mixed.specular, 0.5f * (plain.specular + 0.8f));
  EXPECT_FLOAT_EQ(mixed.roughness, 0.5f * (plain.roughness + 0.1f));
  EXPECT_EQ(mixed.extinction, plain.extinction);
  EXPECT_EQ(mixed.phase, plain.phase);
}

TEST(Preset, WrongBoundariesSayWhatIsWrong) {
  const auto error = [](const std::string& value) {
    return parse_error(with("\"exposure\": 2", "\"exposure\": 2, \"boundary\": " + value));
  };
  const std::string point = R"({"value": 50, "color": "#ffffff"})";
  EXPECT_THAT(error(R"({"from": 60, "to": 60, "points": [)" + point + "]}"),
              HasSubstr("small.json: boundary.to is 60, which must be more than \"from\""));
  EXPECT_THAT(error(R"({"from": -1, "to": 60, "points": [)" + point + "]}"),
              HasSubstr("boundary.from is -1, at least 0 per mm"));
  EXPECT_THAT(error(R"({"from": 1, "to": 60})"), HasSubstr("boundary.points is missing"));
  EXPECT_THAT(error(R"({"from": 1, "to": 60, "points": []})"), HasSubstr("at least 1"));
  EXPECT_THAT(error(R"({"from": 1, "to": 60, "points": [{"value": 101, "color": "#ffffff"}]})"),
              HasSubstr("boundary.points[0].value is 101, beyond those of the preset's \"points\", "
                        "0 to 100"));
  EXPECT_THAT(error(R"({"from": 1, "to": 60, "points": [{"value": 5, "color": "#ffffff",
                       "extinction": 3}]})"),
              HasSubstr("boundary.points[0]: unknown key \"extinction\""));
  EXPECT_THAT(error("[1, 2]"), HasSubstr("boundary: expected an object"));
}

TEST(Preset, BoundariesAreScaledAsTheValuesAre) {
  std::string text = with("\"hu\"", "\"percentile\"");
  text.replace(text.find("\"exposure\": 2"), 13,
               R"("exposure": 2, "boundary": {"from": 0.1, "to": 0.5,
                  "points": [{"value": 0, "color": "#ffffff"}, {"value": 100, "color": "#ff0000"}]})");
  const Preset written = parse_preset(text, "small", "small.json");
  Preset preset = written;
  resolve_percentiles(preset, make_ball(24, 8, 500, 0));
  EXPECT_EQ(preset.boundary->transfer.max_value(), preset.transfer.max_value());
  EXPECT_NEAR(preset.boundary->range.to / preset.boundary->range.from, 5, 1e-4);
  EXPECT_NEAR(preset.surface_strength * preset.boundary->range.to, 0.5f * 0.5f, 1e-4);

  // Of one value: nothing of it is steep.
  preset = written;
  resolve_percentiles(preset, make_ball(24, 8, 500, 500));
  EXPECT_EQ(preset.boundary->transfer.min_value(), 500);
  EXPECT_EQ(preset.boundary->range.share(0), 0);
}

TEST(LightRig, BuiltInOnesLightAWhiteFaceFromEverySide) {
  const std::vector<std::string> names = rig_names();
  EXPECT_THAT(names, testing::ElementsAre("ambient", "dome", "portrait", "rim", "softbox", "studio",
                                          "theatre"));
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
              HasSubstr("small.json: points[1].extinction is -2, at least 0 1/mm"));
  EXPECT_THAT(parse_error(with("\"extinction\": 2", "\"extinctoin\": 2")),
              HasSubstr("small.json: points[1].extinction is missing"));
  EXPECT_THAT(
      parse_error(with("\"specular\"", "\"shine\"")),
      HasSubstr("small.json: points[1]: unknown key \"shine\": misspelt, or made for a newer "
                "version of clipgs; known here: color, extinction"));
  EXPECT_THAT(parse_error(with("#000000", "black")), HasSubstr("points[0].color must be"));
  EXPECT_THAT(parse_error(with("[1, 0.5, 0]", "[1, 2, 0]")),
              HasSubstr("points[1].color is 2, at most 1"));
  EXPECT_THAT(parse_error(with("[0, 2, 0]", "[0, 0, 0]")),
              HasSubstr("lights.keys[0].direction must not be zero"));
  EXPECT_THAT(parse_error(with("\"ct\"", "\"xray\"")),
              HasSubstr("modality \"xray\" is none of ct, mr, photo, pet, us, any"));
  EXPECT_THAT(parse_error(with("\"hu\"", "\"lumens\"")), HasSubstr("units"));
  EXPECT_THAT(parse_error(with("\"exposure\": 2", "\"exposure\": 0")), HasSubstr("exposure"));
  EXPECT_THAT(parse_error(with("\"exposure\": 2", "\"tone\": \"agfa\"")),
              HasSubstr("small.json: tone \"agfa\" is none of srgb, filmic"));
  EXPECT_THAT(parse_error(with("\"exposure\": 2", "\"tone\": 2")),
              HasSubstr("tone must be a string"));
  EXPECT_THAT(parse_error(with("\"phase\": -0.2", "\"phase\": -1")),
              HasSubstr("points[1].phase is -1, at least -0.99"));
  EXPECT_THAT(parse_error(with("\"phase_g\": 0.6", "\"phase_g\": 1")), HasSubstr("phase_g"));
}

// Nothing that is accepted can make a picture take for ever, or of what is no number.
TEST(Preset, EveryQuantityIsBounded) {
  struct Wrong {
    const char* from;
    const char* to;
    const char* says;
  };
  for (const Wrong& wrong : {
           Wrong{"\"extinction\": 2", "\"extinction\": 1e6",
                 "small.json: points[1].extinction is 1e+06, at most 100 1/mm"},
           Wrong{"\"extinction\": 2", "\"extinction\": 1e999", "small.json: not JSON"},
           Wrong{"\"extinction\": 2", "\"extinction\": \"2\"", "must be a finite number"},
           Wrong{"\"value\": 100", "\"value\": 1e30", "points[1].value is 1e+30, at most 1e+09"},
           Wrong{"\"specular\": 0.2", "\"specular\": 1.5", "points[1].specular is 1.5, at most 1"},
           Wrong{"\"roughness\": 0.3", "\"roughness\": 1e-9", "points[1].roughness is 1e-09"},
           Wrong{"\"phase\": -0.2", "\"phase\": 0.9999999", "points[1].phase is 1, at most 0.99"},
           Wrong{"\"phase_g\": 0.6", "\"phase_g\": 7", "small.json: phase_g is 7, at most 0.99"},
           Wrong{"_strength\": 0.5", "_strength\": 1e30", "surface_strength is 1e+30"},
           Wrong{"\"exposure\": 2", "\"exposure\": 1e9", "exposure is 1e+09, at most 10000"},
           Wrong{"\"exposure\": 2",
                 "\"exposure\": 1, \"gradient_opacity\": {\"from\": 0, \"to\": 1e20}",
                 "gradient_opacity.to is 1e+20, at most 1e+09 per mm"},
           Wrong{"\"intensity\": 0.5", "\"intensity\": 1e30",
                 "lights.sky.top.intensity is 1e+30, at most 10000"},
           Wrong{"\"intensity\": 3", "\"intensity\": -3", "lights.keys[0].intensity is -3"},
           Wrong{"_deg\": 10", "_deg\": 90",
                 "keys[0].angular_radius_deg is 90, at most 89 degrees"},
           Wrong{"_deg\": 10", "_deg\": 1, \"distance\": 1e30", "keys[0].distance is 1e+30"},
           Wrong{"_deg\": 10", "_deg\": 1, \"distance\": 0.5", "keys[0].distance is 0.5"},
           Wrong{"[0, 2, 0]", "[0, 1e30, 0]", "lights.keys[0].direction is 1e+30"},
       }) {
    EXPECT_THAT(parse_error(with(wrong.from, wrong.to)), HasSubstr(wrong.says));
  }
  std::string keys = "[";
  for (int i = 0; i < 9; ++i) {
    keys += std::string(i == 0 ? "" : ",") + R"({"direction": [0, 1, 0], "color": "#ffffff"})";
  }
  const std::string text = kSmall;
  const size_t list = text.find("[{\"direction\"");
  EXPECT_THAT(parse_error(text.substr(0, list) + keys + "]}}"),
              HasSubstr("small.json: lights.keys holds 9 entries, at most 8"));
}

TEST(LightRig, PanoramasAreBounded) {
  const TestFolder folder;
  const auto rig = [&](const std::string& more) {
    write_text(folder / "rig.json",
               R"({"sky": {"top": {"color": "#000000"}, "horizon": {"color": "#000000"},
                   "bottom": {"color": "#000000"}}, "keys": [],
                   "environment": {"file": "sky.hdr", )" +
                   more + "}}");
    return error_of([&] { load_rig((folder / "rig.json").string()); });
  };
  EXPECT_THAT(rig("\"turn_deg\": 1e20"), HasSubstr("rig.json: environment.turn_deg is 1e+20"));
  EXPECT_THAT(rig("\"intensity\": 1e20"), HasSubstr("environment.intensity is 1e+20"));
  // One pixel of 2^119: a float, but no light.
  write_text(folder / "sky.hdr",
             "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x80\x80\xf8");
  EXPECT_THAT(rig("\"intensity\": 1"), HasSubstr("sky.hdr: the radiance of pixel 0, 0"));
  EXPECT_THAT(error_of([&] { load_rig((folder / "sky.hdr").string()); }), HasSubstr("to 1e+10;"));
}

// The error says which pixel, counted as pictures are: PFM has its lowest row first.
TEST(LightRig, PanoramasAreLight) {
  const TestFolder folder;
  const auto error = [&](float value) {
    std::vector<float> pixels(4 * 2, 1.0f);
    pixels[1] = value;
    write_text(folder / "sky.pfm",
               "Pf\n4 2\n-1\n" + std::string(reinterpret_cast<const char*>(pixels.data()),
                                             sizeof(float) * pixels.size()));
    return error_of([&] { load_rig((folder / "sky.pfm").string()); });
  };
  EXPECT_EQ(error(2), "");
  EXPECT_THAT(error(std::numeric_limits<float>::quiet_NaN()),
              HasSubstr("sky.pfm: the radiance of pixel 1, 1 (from the top left) is nan, but must "
                        "be 0 to 1e+10; mend it"));
  EXPECT_THAT(error(std::numeric_limits<float>::infinity()), HasSubstr("pixel 1, 1"));
  EXPECT_THAT(error(-1e-3f), HasSubstr("is -0.001, but"));
  write_text(folder / "sky.hdr",
             "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + std::string(8, '\0'));
  EXPECT_THAT(error_of([&] { load_rig((folder / "sky.hdr").string()); }), HasSubstr("is black;"));
  EXPECT_THAT(error_of([&] { load_rig((folder / "sky.exr").string()); }), HasSubstr(".pfm file"));
}

TEST(LabelTable, NamesTheFieldThatIsWrong) {
  const TestFolder folder;
  const auto error = [&](const std::string& entry) {
    write_text(folder / "t.json", "{\"labels\": [{\"label\": 1}, " + entry + "]}");
    return error_of([&] { load_label_table(folder / "t.json"); });
  };
  EXPECT_THAT(error("{\"label\": 2, \"opacity\": 3}"),
              HasSubstr("t.json: labels[1].opacity is 3, at most 1"));
  EXPECT_THAT(error("{\"label\": 1e30}"), HasSubstr("labels[1].label is 1e+30"));
  EXPECT_THAT(error("{\"label\": 1.5}"), HasSubstr("labels[1].label must be a whole number"));
}

// Photographs are multiplied by the materials' colours.
TEST(Preset, PhotographsKeepTheirOwnColours) {
  const Preset photo = load_preset("photo");
  for (const float value : {20.0f, 50.0f, 128.0f, 255.0f}) {
    EXPECT_EQ(photo.transfer.at(value).albedo, Vec3(1));
  }
}

TEST(Preset, EveryBuiltInParsesAndLetsAirThrough) {
  const std::vector<std::string> names = preset_names();
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  for (const char* name :
       {"anatomy", "angiography", "bone", "brain", "generic", "lung", "mr", "muscle", "photo",
        "skeleton", "skin", "skin-and-bone", "soft-tissue", "surgery", "vessels", "x-ray"}) {
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

/// Shares of voxels of one value each, the rest 0; noise of a twentieth.
struct Share {
  float share;
  float value;
};

Volume shares_of(const std::vector<Share>& shares, Modality modality, float scale = 1) {
  Volume volume = make_ball(40, 10, 1, 0);
  volume.modality = modality;
  Rng rng(1);
  size_t i = 0;
  const auto voxels = static_cast<float>(volume.voxels());
  std::vector<float> values(volume.voxels(), 0);
  for (const Share& one : shares) {
    for (const size_t end = i + static_cast<size_t>(one.share * voxels); i < end; ++i) {
      values[i] = scale * one.value * (1 + 0.05f * (rng.uniform() - 0.5f));
    }
  }
  volume.values = std::move(values);
  return volume;
}

float luminance(const Material& material) {
  return glm::dot(material.albedo, Vec3(0.2126f, 0.7152f, 0.0722f));
}

TEST(Preset, PercentilesOfAllLeaveOutWhatIsCommon) {
  const std::string text = with("\"hu\"", "\"percentile-of-all\"");
  EXPECT_EQ(parse_preset(text, "small", "test").units, ValueUnits::kPercentileOfAll);
  for (const float scale : {1.0f, 250.0f}) {
    const Volume volume = shares_of({{0.3f, 1}, {0.01f, 8}}, Modality::kPet, scale);
    Preset preset = load_preset("pet");
    resolve_percentiles(preset, volume);
    EXPECT_EQ(preset.units, ValueUnits::kStored);
    EXPECT_LT(preset.transfer.points()[1].value, 1.1f * scale);  // the 80th percentile
    EXPECT_NEAR(preset.transfer.points().back().value, 8 * scale, 0.3f * scale);
  }
}

TEST(Preset, PetGlowsWhereUptakeIsHigh) {
  // A body, the brain and liver, the heart, a tumour.
  const Volume pet =
      shares_of({{0.25f, 1}, {0.025f, 2}, {0.007f, 6}, {0.002f, 15}}, Modality::kPet);
  const Preset preset = load_preset("auto", pet);
  EXPECT_EQ(preset.name, "pet");
  EXPECT_EQ(preset.transfer.at(0).extinction, 0);
  EXPECT_GT(preset.transfer.at(1).extinction, 0);
  EXPECT_LT(preset.transfer.at(1).extinction, 0.02f);  // 300 mm of body are seen through
  EXPECT_GT(preset.transfer.at(15).extinction, 3);
  float before = 0;
  for (const float uptake : {1.0f, 2.0f, 6.0f, 15.0f}) {
    const Material material = preset.transfer.at(uptake);
    EXPECT_GT(luminance(material), before) << uptake;
    EXPECT_GE(material.albedo.r, material.albedo.g);  // never blue or green
    EXPECT_GE(material.albedo.g, material.albedo.b);
    before = luminance(material);
  }
}

TEST(Preset, MrAngiographiesShowVesselsOutOfTheDark) {
  const std::vector<Share> head = {{0.3f, 60}, {0.05f, 100}, {0.006f, 250}};
  const std::vector<Share> vessels = {{0.006f, 250}};  // all else cut away
  for (const std::vector<Share>& shares : {head, vessels}) {
    const Preset preset = load_preset("mra", shares_of(shares, Modality::kMr));
    EXPECT_EQ(preset.transfer.at(0).extinction, 0);
    if (shares.size() > 1) {
      EXPECT_EQ(preset.transfer.at(60).extinction, 0);
    }
    const Material blood = preset.transfer.at(250);
    EXPECT_GT(blood.extinction, 2);
    EXPECT_GT(blood.albedo.r, 4 * blood.albedo.g);
  }
}

TEST(Preset, UltrasoundIsEmptyWhereNothingEchoes) {
  const Volume us = shares_of({{0.2f, 8}, {0.4f, 90}, {0.05f, 200}}, Modality::kUltrasound);
  const Preset preset = load_preset("auto", us);
  EXPECT_EQ(preset.name, "ultrasound");
  EXPECT_EQ(preset.transfer.at(8).extinction, 0);  // fluid
  EXPECT_GT(preset.transfer.at(90).extinction, 0.3f);
  EXPECT_GT(luminance(preset.transfer.at(200)), luminance(preset.transfer.at(88)));
}

TEST(Preset, MicroCtShowsBoneAndNoFlesh) {
  const Preset preset = load_preset(
      "micro-ct", shares_of({{0.5f, 80}, {0.06f, 150}, {0.01f, 190}}, Modality::kUnknown));
  EXPECT_EQ(preset.transfer.at(80).extinction, 0);
  EXPECT_GT(preset.transfer.at(155).extinction, 20);  // opaque within a tenth of a millimetre
}

}  // namespace
}  // namespace clipgs
