#include "splat/scene_file.h"

#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/json_reader.h"
#include "splat/ply.h"
#include "splat/sh.h"
#include "splat/test_scene.h"

namespace clipgs {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::filesystem::path temporary_scene(const std::string& name) {
  return std::filesystem::path(::testing::TempDir()) / ("clipgs_scene_test_" + name);
}

TEST(SceneFile, RoundTripKeepsEveryField) {
  Scene written = random_scene(200, 2, 5);
  written.look = {"0123456789abcdef", "Bone", "Bone and contrast alone.", Modality::kCt,
                  BodyPart::kHead};
  write_scene(temporary_scene("a.ply"), written);
  const Scene read = read_scene(temporary_scene("a.ply"));
  EXPECT_EQ(read.sphere.center, written.sphere.center);
  EXPECT_EQ(read.sphere.radius, written.sphere.radius);
  EXPECT_EQ(read.bounds.min, written.bounds.min);
  EXPECT_EQ(read.bounds.max, written.bounds.max);
  EXPECT_EQ(read.axis, written.axis);
  EXPECT_EQ(read.extent, written.extent);
  EXPECT_EQ(read.title, written.title);
  EXPECT_EQ(read.preset, written.preset);
  EXPECT_EQ(read.created, written.created);
  EXPECT_EQ(read.look, written.look);
  ASSERT_EQ(read.gaussians.size(), 200u);
  ASSERT_EQ(read.gaussians.sh_degree(), 2);
  for (size_t i = 0; i < 200; ++i) {
    EXPECT_LT(glm::length(read.gaussians.mean(i) - written.gaussians.mean(i)), 1e-3f);
    const Vec3 d = fibonacci_sphere(static_cast<int>(i), 200);
    EXPECT_LT(glm::length(sh_color(read.gaussians, i, d) - sh_color(written.gaussians, i, d)),
              1e-5f);
  }
}

TEST(SceneFile, TitlesOf500CharactersOfAnyScriptAreKeptWhole) {
  for (const char* const character : {"x", "ü", "頭", "🫀", "\u0915\u094d\u0937\u093f"}) {
    Scene written = random_scene(2, 0, 5);
    written.title.clear();
    for (int i = 0; i < 500; ++i) {
      written.title += character;
    }
    const nlohmann::json json = scene_to_json(written, scene_to_world());
    Scene read;
    scene_from_json(json, "x", read);
    EXPECT_EQ(read.title, written.title);
    // What readers of before took.
    const std::string beginning = json.at("title");
    EXPECT_LE(beginning.size(), 256u);
    EXPECT_GE(beginning.size(), 253u);
    EXPECT_TRUE(written.title.starts_with(beginning));
    EXPECT_NO_THROW(json.dump());  // which refuses half characters
  }
}

TEST(SceneFile, KeepsStatesLayersAndExtras) {
  Scene written = random_scene(5, 1, 5);
  written.states = {200, -30.5f, 0.75f, false};
  written.layers = {0, 199, 7, 7, 100};
  const SceneExtras extras{{{"mark", {1, 2, 3, 4, 5}}}, {{"kind", "test"}}};
  write_scene(temporary_scene("states.ply"), written, extras);
  SceneExtras read_extras{{{"mark", {}}, {"other", {}}}, {}};
  const Scene read = read_scene(temporary_scene("states.ply"), &read_extras);
  EXPECT_EQ(read.states.count, 200);
  EXPECT_EQ(read.states.first, -30.5f);
  EXPECT_EQ(read.states.spacing, 0.75f);
  EXPECT_FALSE(read.states.keeps_below);
  EXPECT_EQ(read.layers, written.layers);
  EXPECT_EQ(read_extras.columns["mark"], (std::vector<float>{1, 2, 3, 4, 5}));
  EXPECT_TRUE(read_extras.columns["other"].empty());
  EXPECT_EQ(read_extras.keys["kind"], "test");

  write_scene(temporary_scene("none.ply"), random_scene(5, 1, 5));
  EXPECT_EQ(read_scene(temporary_scene("none.ply")).states.count, 0);
  EXPECT_TRUE(read_scene(temporary_scene("none.ply")).layers.empty());
  written.states.count = 150;  // less than a layer
  write_scene(temporary_scene("states.ply"), written);
  EXPECT_THAT([] { read_scene(temporary_scene("states.ply")); },
              ThrowsMessage<Error>(HasSubstr("layer of splat 1 is 199")));
}

FaceGain some_gain() {
  FaceGain gain;
  for (size_t k = 0; k < gain.coefficients.size(); ++k) {
    const auto n = static_cast<float>(k);
    gain.coefficients[k] = Vec3(0.01f * n, -0.02f * n, k == 2 ? 0.1f : 0.0f);
  }
  return gain;
}

// web/test/unit/face_gain.test.ts expects the same numbers of the viewer.
TEST(FaceGain, DependsOnTheNormal) {
  const Vec3 gain = some_gain().at(Vec3(0.48f, -0.6f, 0.64f));
  EXPECT_NEAR(gain.x, 0.938696f, 1e-5f);
  EXPECT_NEAR(gain.y, 1.134881f, 1e-5f);
  EXPECT_NEAR(gain.z, 1.031765f, 1e-5f);
  EXPECT_TRUE(FaceGain().none());
  EXPECT_EQ(FaceGain().at(Vec3(0, 1, 0)), Vec3(1));
}

TEST(FaceGain, EndsBelowTheFace) {
  EXPECT_EQ(FaceGain::share(-3.0), 1);
  EXPECT_EQ(FaceGain::share(1.5), 1);
  EXPECT_EQ(FaceGain::share(2.25), 0.5);
  EXPECT_EQ(FaceGain::share(3.0), 0);
}

TEST(SceneFile, KeepsTheGainOfFaces) {
  Scene written = random_scene(5, 1, 5);
  written.face_gain = some_gain();
  write_scene(temporary_scene("gain.ply"), written);
  EXPECT_EQ(read_scene(temporary_scene("gain.ply")).face_gain, written.face_gain);
  nlohmann::json json = scene_to_json(written, scene_to_world());
  json["face_gain"][15][2] = 99;
  Scene read;
  EXPECT_THAT([&] { scene_from_json(json, "gain.json", read); },
              ThrowsMessage<Error>(HasSubstr("face_gain")));
}

TEST(SceneFile, SaysThatSplatsArePlaced) {
  Scene written = random_scene(5, 1, 5);
  nlohmann::json json = scene_to_json(written, scene_to_world());
  EXPECT_FALSE(json.contains("splats"));
  written.placed = true;
  json = scene_to_json(written, scene_to_world());
  EXPECT_EQ(json.at("splats"), "placed");
  Scene read;
  scene_from_json(json, "placed.json", read);
  EXPECT_TRUE(read.placed);
  json["splats"] = "guessed";
  EXPECT_THAT([&] { scene_from_json(json, "placed.json", read); },
              ThrowsMessage<Error>(HasSubstr("splats")));
}

TEST(SceneFile, SaysHowFarItIsTrained) {
  Scene written = random_scene(5, 1, 5);
  nlohmann::json json = scene_to_json(written, scene_to_world());
  EXPECT_FALSE(json.contains("trained"));
  written.trained = 0.25f;
  json = scene_to_json(written, scene_to_world());
  Scene read;
  scene_from_json(json, "trained.json", read);
  EXPECT_EQ(read.trained, 0.25f);
  json["trained"] = 1.5;
  EXPECT_THAT([&] { scene_from_json(json, "trained.json", read); },
              ThrowsMessage<Error>(HasSubstr("trained")));
}

TEST(PlaneStates, NearestAndPlane) {
  const PlaneStates states{11, -5, 1, true};
  EXPECT_EQ(states.nearest(-100), 0);
  EXPECT_EQ(states.nearest(0.4f), 5);
  EXPECT_EQ(states.nearest(100), 10);
  EXPECT_EQ(states.plane({0, 0, 1}, 3).normal, Vec3(0, 0, -1));
  EXPECT_EQ(states.plane({0, 0, 1}, 3).offset, -3);
}

// web/test/unit/states.test.ts expects the same numbers of the viewer.
TEST(PlaneStates, OfAScenesExtent) {
  const PlaneStates states = PlaneStates::over({-120.5f, 96});
  EXPECT_EQ(states.count, 200);
  EXPECT_FLOAT_EQ(states.spacing, 1.0825f);
  EXPECT_FLOAT_EQ(states.position(0), -119.4175f);
  EXPECT_FLOAT_EQ(states.position(199), 96);
  EXPECT_TRUE(states.keeps_below);
  EXPECT_EQ(PlaneStates::over({5, 5}).nearest(5), 0);
}

TEST(SceneFile, PlyIsInMetresWithTheHeadUp) {
  const Scene scene = random_scene(1, 0, 5);
  write_scene(temporary_scene("b.ply"), scene);
  const Vec3 ras = scene.gaussians.mean(0);
  const Vec3 p = read_ply(temporary_scene("b.ply")).mean(0);
  EXPECT_LT(glm::length(p - Vec3(-ras.x, -ras.z, -ras.y) * 0.001f), 1e-6f);
}

TEST(SceneFile, OneLineErrors) {
  EXPECT_THAT([] { write_scene(temporary_scene("c.sog"), random_scene(1, 0, 1)); },
              ThrowsMessage<Error>(HasSubstr(".ply")));
  write_ply(temporary_scene("alone.ply"), random_gaussians(1, 0, 1));
  std::filesystem::remove(temporary_scene("alone.json"));
  EXPECT_THAT([] { read_scene(temporary_scene("alone.ply")); },
              ThrowsMessage<Error>(HasSubstr("alone.json")));
  write_text(temporary_scene("alone.json"), "{\"version\": 1,");
  EXPECT_THROW(read_scene(temporary_scene("alone.ply")), Error);

  Scene scene = random_scene(1, 0, 1);
  scene.sphere.radius = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT([&] { write_scene(temporary_scene("d.ply"), scene); },
              ThrowsMessage<Error>(HasSubstr("radius")));
  EXPECT_FALSE(std::filesystem::exists(temporary_scene("d.ply")));
}

TEST(SceneFile, EveryKeyIsChecked) {
  const nlohmann::json whole = scene_to_json(random_scene(1, 0, 1), scene_to_world());
  for (const auto& entry : whole.items()) {
    nlohmann::json missing = whole;
    missing.erase(entry.key());
    nlohmann::json wrong = whole;
    wrong[entry.key()] = nullptr;
    Scene scene;
    EXPECT_THAT([&] { scene_from_json(missing, "x.json", scene); },
                ThrowsMessage<Error>(HasSubstr(entry.key())));
    EXPECT_THROW(scene_from_json(wrong, "x.json", scene), Error) << entry.key();
  }
}

TEST(SceneFile, NumbersAreShort) {
  EXPECT_EQ(json_number(0.1f).dump(), "0.1");
  EXPECT_EQ(json_number(1.0f / 3.0f).get<float>(), 1.0f / 3.0f);
}

}  // namespace
}  // namespace clipgs
