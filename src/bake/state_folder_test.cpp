#include "bake/state_folder.h"

#include <cmath>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "bake/test_model.h"
#include "core/error.h"
#include "core/file.h"
#include "splat/ply.h"
#include "splat/scene_file.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::random_model;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

constexpr int kFolderStates = 6;

class StateFolder : public ::testing::Test {
 protected:
  StateFolder()
      : folder_(fs::path(::testing::TempDir()) / ("clipgs-states-" + std::to_string(getpid()))) {
    export_states(model_, kFolderStates, folder_);
  }
  ~StateFolder() override { fs::remove_all(folder_); }

  fs::path planes_path() const { return folder_ / kPlanesFile; }
  BakedScene bake_folder() const { return bake_states(folder_, planes_path()); }
  json planes() const { return json::parse(read_text(planes_path())); }
  void change_planes(const std::function<void(json&)>& change) const {
    json changed = planes();
    change(changed);
    write_text(planes_path(), changed.dump());
  }
  void change_state(const char* name, const std::function<void(Gaussians&)>& change) const {
    Gaussians state = read_ply(folder_ / name);
    change(state);
    write_ply(folder_ / name, state);
  }
  /// bake_states fails with one line that says all this.
  void expect_failure(const std::string& file, const std::string& what) const {
    EXPECT_THAT([&] { bake_folder(); }, ThrowsMessage<Error>(AllOf(HasSubstr(file), HasSubstr(what),
                                                                   Not(HasSubstr("\n")))));
  }

  const UniaxialModel model_ = random_model(800, 2, 0.2f);
  fs::path folder_;
};

void expect_same_scene(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.gaussians.size(), b.gaussians.size());
  ASSERT_EQ(a.gaussians.sh_degree(), b.gaussians.sh_degree());
  EXPECT_EQ(a.layers, b.layers);
  for (size_t i = 0; i < a.gaussians.size(); ++i) {
    EXPECT_LT(glm::distance(a.gaussians.mean(i), b.gaussians.mean(i)), 1e-3f);
    const float dot = glm::dot(a.gaussians.rotation(i), b.gaussians.rotation(i));
    EXPECT_NEAR(std::abs(dot), 1, 1e-5f);
  }
  for (int p = 0; p < a.gaussians.planes(); ++p) {
    for (size_t i = 0; p >= Gaussians::kOpacity && i < a.gaussians.size(); ++i) {
      ASSERT_NEAR(a.gaussians.plane(p)[i], b.gaussians.plane(p)[i], 1e-4f) << p;
    }
  }
  EXPECT_EQ(a.states.count, b.states.count);
  EXPECT_NEAR(a.states.first, b.states.first, 1e-3f);
  EXPECT_NEAR(a.states.spacing, b.states.spacing, 1e-4f);
  EXPECT_EQ(a.states.keeps_below, b.states.keeps_below);
}

TEST_F(StateFolder, ComesBackAsTheBakedScene) {
  const BakedScene direct = bake(model_, kFolderStates);
  const BakedScene back = bake_folder();
  expect_same_scene(back.scene, direct.scene);
  EXPECT_EQ(back.statistics.from_nearest, direct.statistics.from_nearest);
  EXPECT_EQ(back.statistics.from_uncut, direct.statistics.from_uncut);
  EXPECT_GT(back.statistics.from_uncut, 0u);
  EXPECT_EQ(back.scene.title, direct.scene.title);
  EXPECT_EQ(back.scene.extent, direct.scene.extent);
  EXPECT_EQ(back.scene.sphere.radius, direct.scene.sphere.radius);
}

TEST_F(StateFolder, HoldsEveryGaussianInEveryState) {
  const Similarity world = scene_to_world();
  for (int k = 0; k < kFolderStates; ++k) {
    const PlaneStates states = choose_states(model_, kFolderStates);
    const Plane plane = states.plane(model_.scene.axis, states.position(k));
    UniaxialState state;
    make_state(model_.scene.gaussians, model_.parameters, plane.offset, state);
    const std::string file = "state_00" + std::to_string(k) + ".ply";
    const Gaussians written = transform(read_ply(folder_ / file), world);
    ASSERT_EQ(written.size(), 800u);
    size_t n = 0;
    for (std::uint32_t i = 0; i < 800; ++i) {
      const bool shown = n < state.ids.size() && state.ids[n] == i;
      const Vec3 mean = shown ? state.gaussians.mean(n) : model_.scene.gaussians.mean(i);
      EXPECT_LT(glm::distance(written.mean(i), mean), 1e-3f);
      EXPECT_EQ(written.plane(Gaussians::kOpacity)[i],
                shown ? state.gaussians.plane(Gaussians::kOpacity)[n] : -20);
      n += shown ? 1 : 0;
    }
    const json entry = planes()["states"][static_cast<size_t>(k)];
    EXPECT_EQ(entry["file"], file);
    EXPECT_NEAR(entry["plane"][3].get<float>(), plane.offset, 1e-3f);
    EXPECT_NEAR(entry["plane"][2].get<float>(), plane.normal.z, 1e-6f);
  }
}

TEST_F(StateFolder, PlanesAndFilesAreEnough) {
  const BakedScene direct = bake(model_, kFolderStates);
  change_planes([](json& p) { p = {{"version", 1}, {"states", p["states"]}}; });
  const BakedScene back = bake_folder();
  // The first state's plane is the lowest, so the axis is the direction of ascent.
  EXPECT_LT(glm::distance(back.scene.axis, model_.scene.axis), 1e-5f);
  EXPECT_TRUE(back.scene.states.keeps_below);
  EXPECT_EQ(back.scene.gaussians.size(),
            direct.statistics.from_slab + direct.statistics.from_nearest);
  EXPECT_EQ(back.statistics.from_uncut, 0u);
  EXPECT_EQ(back.scene.title, "");
  Box box;
  float farthest = 0;
  for (size_t i = 0; i < back.scene.gaussians.size(); ++i) {
    const Vec3 mean = back.scene.gaussians.mean(i);
    box.add(mean);
    farthest = std::max(farthest, glm::distance(mean, back.scene.sphere.center));
    const float position = glm::dot(back.scene.axis, mean);
    EXPECT_GE(position, back.scene.extent.x);
    EXPECT_LE(position, back.scene.extent.y);
  }
  EXPECT_EQ(box.min, back.scene.bounds.min);
  EXPECT_EQ(box.max, back.scene.bounds.max);
  EXPECT_EQ(farthest, back.scene.sphere.radius);
}

TEST_F(StateFolder, ListedDownwardsIsTheSameScene) {
  const BakedScene upwards = bake_folder();
  change_planes([](json& p) { std::reverse(p["states"].begin(), p["states"].end()); });
  expect_same_scene(bake_folder().scene, upwards.scene);
}

TEST_F(StateFolder, AnotherWorldIsTakenAsItSays) {
  const BakedScene before = bake_folder();
  // The same numbers as millimetres of a frame turned by 90° about z.
  change_planes([](json& p) {
    p["world"] = {{"scene_to_ras_mm", {{0, -1, 0, 5}, {1, 0, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}}};
    p.erase("axis");
    for (json& state : p["states"]) {
      json& plane = state["plane"];
      // World to scene as clipgs has it, then the new world, a thousand times smaller.
      const double r = plane[0], a = plane[1], s = plane[2], c = plane[3];
      plane = {s, -r, -a, c / 1000 + 5 * s};
    }
  });
  const Scene after = bake_folder().scene;
  ASSERT_EQ(after.gaussians.size(), before.scene.gaussians.size());
  const Vec3 mean = before.scene.gaussians.mean(0);
  EXPECT_LT(glm::distance(after.gaussians.mean(0),
                          Vec3(0.001f * mean.z + 5, -0.001f * mean.x, -0.001f * mean.y)),
            1e-4f);
  EXPECT_NEAR(after.states.spacing, before.scene.states.spacing / 1000, 1e-4f);
}

TEST_F(StateFolder, MissingOrUnreadableStates) {
  change_state("state_001.ply", [](Gaussians& g) { g.plane(0)[3] = std::nanf(""); });
  expect_failure("state_001.ply", "not a finite number");
  fs::remove(folder_ / "state_004.ply");
  expect_failure("state_004.ply", "is missing");
  fs::remove(planes_path());
  expect_failure(kPlanesFile, "cannot be read");
}

TEST_F(StateFolder, StatesOfUnlikeModels) {
  change_state("state_002.ply", [](Gaussians& g) { g = random_gaussians(799, 2, 1); });
  expect_failure("state_002.ply", "799 splats");
  change_state("state_002.ply", [](Gaussians& g) { g = random_gaussians(800, 1, 1); });
  expect_failure("state_002.ply", "degree 1");
}

TEST_F(StateFolder, PlanesThatMakeNoStates) {
  const json whole = planes();
  const auto refuses = [&](const std::function<void(json&)>& change, const std::string& what) {
    write_text(planes_path(), whole.dump());
    change_planes(change);
    expect_failure(kPlanesFile, what);
  };
  refuses([](json& p) { std::swap(p["states"][2], p["states"][3]); },
          "state_002.ply is out of order");
  refuses([](json& p) { p["states"][3]["plane"] = p["states"][2]["plane"]; }, "out of order");
  refuses([](json& p) { p["states"][1]["plane"] = {1, 0, 0, 0}; }, "state_001.ply is not parallel");
  refuses(
      [](json& p) {
        for (json& number : p["states"][5]["plane"]) {
          number = -number.get<double>();
        }
      },
      "state_005.ply keeps the other side");
  refuses([](json& p) { p["states"][4]["plane"][3] = p["states"][4]["plane"][3].get<float>() + 1; },
          "evenly spaced");
  refuses([](json& p) { p["states"] = json::array({p["states"][0]}); }, "lists 1 states");
  refuses([](json& p) { p.erase("states"); }, "\"states\" is missing");
  refuses([](json& p) { p["states"][1].erase("file"); }, "states[1]: \"file\"");
  refuses([](json& p) { p["states"][1]["plane"] = {0, 0, 2, 1}; }, "states[1]: \"plane\"");
  refuses([](json& p) { p["states"][1]["plane"] = {0, 0, 1}; }, "states[1]: \"plane\"");
  refuses([](json& p) { p["axis"] = {1, 0, 0}; }, "\"axis\"");
  refuses([](json& p) { p["world"] = 7; }, "world");
  refuses([](json& p) { p["version"] = 2; }, "newer clipgs");
  write_text(planes_path(), "{\"states\": [");
  expect_failure(kPlanesFile, "JSON");
}

TEST_F(StateFolder, SpacingMayBeOffByOnePercent) {
  const float spacing = choose_states(model_, kFolderStates).spacing;
  change_planes([&](json& p) {
    json& offset = p["states"][3]["plane"][3];
    offset = offset.get<float>() + 0.009f * spacing;
  });
  EXPECT_NO_THROW(bake_folder());
}

TEST_F(StateFolder, UnlikeShIsTakenFromTheFirstStateWithAWarning) {
  const Scene before = bake_folder().scene;
  change_state("state_005.ply", [](Gaussians& g) {
    for (size_t i = 0; i < g.size(); ++i) {
      g.plane(Gaussians::kSh + 3)[i] += 1;
    }
  });
  ::testing::internal::CaptureStderr();
  const Scene after = bake_folder().scene;
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(said, HasSubstr("state_005.ply: SH above order 0 differ"));
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1);
  size_t changed = 0;
  for (size_t i = 0; i < before.gaussians.size(); ++i) {
    const Gaussians& a = before.gaussians;
    const Gaussians& b = after.gaussians;
    changed += std::abs(a.plane(Gaussians::kSh + 3)[i] - b.plane(Gaussians::kSh + 3)[i]) > 1e-6f;
  }
  EXPECT_LT(changed, before.gaussians.size() / 2);  // those that no state before it shows
}

TEST_F(StateFolder, TransparentStatesAreNoScene) {
  for (const auto& entry : fs::directory_iterator(folder_)) {
    if (entry.path().extension() == ".ply") {
      change_state(entry.path().filename().c_str(), [](Gaussians& g) {
        std::fill_n(g.plane(Gaussians::kOpacity), g.size(), -6.0f);
      });
    }
  }
  expect_failure("no state shows a splat", "1/255");
}

TEST_F(StateFolder, FullDiskIsSaidBeforeAnythingIsWritten) {
  UniaxialModel large = random_model(400000, 3, 0.2f);
  const fs::path folder = folder_ / "large";
  fs::create_directories(folder);
  if (fs::space(folder).available > std::uintmax_t{6} << 40) {
    GTEST_SKIP() << "this disk has room for it";
  }
  EXPECT_THAT([&] { export_states(large, kMaxStates, folder); },
              ThrowsMessage<Error>(AllOf(HasSubstr("needs 6501"), HasSubstr("free"))));
  EXPECT_TRUE(fs::is_empty(folder));
}

}  // namespace
}  // namespace clipgs
