// clipgs bake as a user runs it, and what becomes of states and layers on the way to a case.
#include <algorithm>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "bake/test_model.h"
#include "cli/process.h"
#include "core/file.h"
#include "core/image.h"
#include "measure/metrics.h"
#include "splat/scene_file.h"
#include "train/model_file.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing_support::Finished;
using testing_support::run_clipgs;

class BakeCommand : public ::testing::Test {
 protected:
  BakeCommand()
      : folder_(fs::path(::testing::TempDir()) / ("clipgs-bake-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    write_model(at("model.ply"), test::random_model(300, 1, 0.2f));
  }
  ~BakeCommand() override { fs::remove_all(folder_); }

  std::string at(const std::string& name) const { return (folder_ / name).string(); }

  nlohmann::json info(const std::string& name) const {
    const Finished finished = run_clipgs({"info", at(name), "--json"});
    EXPECT_EQ(finished.status, 0) << finished.err;
    return nlohmann::json::parse(finished.out, nullptr, false);
  }

  fs::path folder_;
};

TEST_F(BakeCommand, MakesASceneThatKeepsItsLayersInACaseAndBack) {
  const Finished baked =
      run_clipgs({"bake", at("model.ply"), "-o", at("scene.ply"), "--states", "9", "--json"});
  ASSERT_EQ(baked.status, 0) << baked.err;
  const nlohmann::json said = nlohmann::json::parse(baked.out);
  const Scene scene = read_scene(at("scene.ply"));
  EXPECT_EQ(said["primitives"], 300);
  EXPECT_EQ(said["kept"], scene.gaussians.size());
  EXPECT_EQ(said["states"].size(), 9u);
  EXPECT_GT(said["bytes"]["raw"], said["bytes"]["consolidated"]);
  ASSERT_EQ(scene.layers.size(), scene.gaussians.size());

  ASSERT_EQ(run_clipgs({"pack", at("scene.ply"), "-o", at("case.sog")}).status, 0);
  ASSERT_EQ(run_clipgs({"unpack", at("case.sog"), "-o", at("again.ply")}).status, 0);
  std::vector<std::uint16_t> before = scene.layers;
  std::vector<std::uint16_t> after = read_scene(at("again.ply")).layers;
  std::ranges::sort(before);
  std::ranges::sort(after);
  EXPECT_EQ(after, before);
  ASSERT_EQ(run_clipgs({"export", at("case.sog"), "-o", at("plain.ply")}).status, 0);
  EXPECT_EQ(read_text(at("plain.ply")).substr(0, 2000).find("layer"), std::string::npos);

  for (const char* name : {"scene.ply", "case.sog", "again.ply"}) {
    const nlohmann::json states = info(name)["states"];
    EXPECT_EQ(states["count"], 9) << name;
    EXPECT_EQ(states["keeps"], "below") << name;
    EXPECT_EQ(states["layers"], true) << name;
    EXPECT_NEAR(states["spacing_mm"].get<float>(), scene.states.spacing, 1e-4f) << name;
  }
}

TEST_F(BakeCommand, StatesAreDrawnByTheirLayers) {
  ASSERT_EQ(run_clipgs({"bake", at("model.ply"), "-o", at("scene.ply"), "--states", "9"}).status,
            0);
  ASSERT_EQ(run_clipgs({"pack", at("scene.ply"), "-o", at("case.sog")}).status, 0);
  const auto render = [&](const std::string& scene, const std::vector<std::string>& options) {
    std::vector<std::string> words = {"render", at(scene), "-o", at("x.png"), "--size", "96x96"};
    words.insert(words.end(), options.begin(), options.end());
    return run_clipgs(words);
  };
  for (const char* scene : {"scene.ply", "case.sog"}) {
    ASSERT_EQ(render(scene, {"--state", "4"}).status, 0);
    const Image exact = read_png(at("x.png"));
    ASSERT_EQ(render(scene, {"--state", "4", "--clip", "layers", "--reference"}).status, 0);
    const Image slow = read_png(at("x.png"));
    ASSERT_EQ(render(scene, {"--state", "4", "--clip", "layers"}).status, 0);
    const Image fast = read_png(at("x.png"));
    EXPECT_GT(psnr(fast, slow), 50) << scene;
    EXPECT_LT(psnr(fast, exact), 45) << scene;
  }

  const Finished oblique = render("case.sog", {"--plane", "1,0,1,0", "--clip", "layers"});
  EXPECT_EQ(oblique.status, 1);
  EXPECT_THAT(oblique.err, HasSubstr("one plane of normal"));
  write_scene(at("plain.ply"), random_scene(50, 0, 1));
  const Finished plain = render("plain.ply", {"--state", "4", "--clip", "layers"});
  EXPECT_EQ(plain.status, 1);
  EXPECT_THAT(plain.err, HasSubstr("plain.ply: has no layers"));
  EXPECT_THAT(run_clipgs({"refine", at("scene.ply"), "--dataset", at("none"), "-o", at("y.ply"),
                          "--clip", "layers"})
                  .status,
              2);
}

TEST_F(BakeCommand, StatesGoOutAndComeBack) {
  const Finished out = run_clipgs({"bake", at("model.ply"), "-o", at("direct.ply"), "--states", "5",
                                   "--export-states", at("states")});
  ASSERT_EQ(out.status, 0) << out.err;
  EXPECT_THAT(out.out, HasSubstr("in 5 states"));
  EXPECT_TRUE(fs::exists(at("states/state_004.ply")));
  const Finished back =
      run_clipgs({"bake", "--from-states", at("states"), "-o", at("back.ply"), "--json"});
  ASSERT_EQ(back.status, 0) << back.err;
  EXPECT_EQ(read_scene(at("back.ply")).layers, read_scene(at("direct.ply")).layers);

  fs::rename(at("states/planes.json"), at("planes.json"));
  EXPECT_THAT(run_clipgs({"bake", "--from-states", at("states"), "-o", at("x.ply")}).err,
              HasSubstr("planes.json"));
  EXPECT_EQ(run_clipgs({"bake", "--from-states", at("states"), "--planes", at("planes.json"), "-o",
                        at("x.ply")})
                .status,
            0);
  const Finished over = run_clipgs({"bake", "--from-states", at("states"), "--planes",
                                    at("planes.json"), "-o", at("planes.ply")});
  EXPECT_EQ(over.status, 2);
  EXPECT_THAT(over.err, HasSubstr("would replace the planes"));
}

TEST_F(BakeCommand, WrongUseAndWrongFiles) {
  EXPECT_EQ(run_clipgs({"bake", at("model.ply")}).status, 2);
  EXPECT_EQ(run_clipgs({"bake", "-o", at("x.ply")}).status, 2);
  EXPECT_EQ(run_clipgs({"bake", at("model.ply"), "-o", at("x.ply"), "--states", "1"}).status, 2);
  EXPECT_EQ(
      run_clipgs({"bake", at("model.ply"), "-o", at("x.ply"), "--from-states", at("")}).status, 2);
  EXPECT_EQ(run_clipgs({"bake", at("model.ply"), "-o", at("x.ply"), "--planes", "p"}).status, 2);
  EXPECT_EQ(run_clipgs({"bake", at("model.ply"), "-o", at("model.ply")}).status, 2);
  const Finished missing = run_clipgs({"bake", at("missing.ply"), "-o", at("x.ply")});
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.err, HasSubstr("missing.ply"));
  write_scene(at("scene.ply"), random_scene(5, 0, 1));
  const Finished scene = run_clipgs({"bake", at("scene.ply"), "-o", at("x.ply")});
  EXPECT_EQ(scene.status, 1);
  EXPECT_THAT(scene.err, HasSubstr("is a scene, not a model"));
  EXPECT_FALSE(fs::exists(at("x.ply")));
}

TEST_F(BakeCommand, InfoKnowsModels) {
  const nlohmann::json model = info("model.ply");
  EXPECT_EQ(model["kind"], "model");
  EXPECT_EQ(model["splats"], 300);
  EXPECT_EQ(model["truncation"], "learned");
  EXPECT_EQ(model["thresholds"], 300);
  EXPECT_EQ(model["adjustment"]["width"], 32);
  EXPECT_GT(model["adjustment"]["weights"], 1000);
  EXPECT_FALSE(model.contains("states"));
}

}  // namespace
}  // namespace clipgs
