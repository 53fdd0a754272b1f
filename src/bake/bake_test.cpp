#include "bake/bake.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <optional>

#include "bake/test_model.h"
#include "core/error.h"
#include "core/parallel.h"

namespace clipgs {
namespace {

using test::random_model;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr int kStates = 23;

/// Everything that the consolidator may choose from, all at once.
struct AllStates {
  PlaneStates states;
  std::vector<UniaxialState> each;
};

AllStates make_all(const UniaxialModel& model) {
  AllStates all{choose_states(model, kStates), std::vector<UniaxialState>(kStates)};
  for (int k = 0; k < kStates; ++k) {
    const Plane plane = all.states.plane(model.scene.axis, all.states.position(k));
    make_state(model.scene.gaussians, model.parameters, plane.offset,
               all.each[static_cast<size_t>(k)]);
  }
  return all;
}

/// A primitive as one state shows it.
struct Version {
  int state;
  size_t index;    // in the state
  float distance;  // mm from the state's plane, kept side positive
  bool in_slab;
};

/// Of each primitive, what the states show of it.
std::map<std::uint32_t, std::vector<Version>> versions_of(const UniaxialModel& model,
                                                          const AllStates& all) {
  std::map<std::uint32_t, std::vector<Version>> result;
  for (int k = 0; k < kStates; ++k) {
    const UniaxialState& state = all.each[static_cast<size_t>(k)];
    const Plane plane = all.states.plane(model.scene.axis, all.states.position(k));
    for (size_t n = 0; n < state.ids.size(); ++n) {
      if (state.gaussians.opacity(n) >= 1.0f / 255) {
        const float d = plane.signed_distance(state.gaussians.mean(n));
        result[state.ids[n]].push_back({k, n, d, d >= 0 && d < all.states.spacing});
      }
    }
  }
  return result;
}

/// By the definition, in words: of its own slabs that in which it is most central, else the slab
/// nearest to it; the first of equals.
Version chosen(const std::vector<Version>& versions, float spacing) {
  const Version* best = nullptr;
  const auto off_center = [&](const Version& v) { return std::abs(v.distance - spacing / 2); };
  const auto to_slab = [&](const Version& v) {
    return v.distance < 0 ? -v.distance : v.distance - spacing;
  };
  for (const Version& v : versions) {
    if (v.in_slab && (best == nullptr || off_center(v) < off_center(*best))) {
      best = &v;
    }
  }
  if (best != nullptr) {
    return *best;
  }
  for (const Version& v : versions) {
    if (best == nullptr || to_slab(v) < to_slab(*best) - 1e-5f) {
      best = &v;
    }
  }
  return *best;
}

/// Tags every primitive by the one parameter that no state changes.
UniaxialModel tagged(UniaxialModel model) {
  for (size_t i = 0; i < model.scene.gaussians.size(); ++i) {
    model.scene.gaussians.plane(Gaussians::kSh)[i] = static_cast<float>(i);
  }
  return model;
}

class Bake : public ::testing::TestWithParam<std::tuple<float, bool>> {
 protected:
  const UniaxialModel model_ =
      tagged(random_model(2000, 1, std::get<0>(GetParam()), std::get<1>(GetParam())));
};

INSTANTIATE_TEST_SUITE_P(Windows, Bake,
                         ::testing::Combine(::testing::Values(0.08f, 0.0f), ::testing::Bool()));

TEST_P(Bake, EveryShownPrimitiveIsThereOnceAsItsStateHasIt) {
  const AllStates all = make_all(model_);
  const auto versions = versions_of(model_, all);
  const BakedScene baked = bake(model_, kStates);
  const Scene& scene = baked.scene;
  std::map<std::uint32_t, size_t> place;  // of each primitive in the scene
  for (size_t n = 0; n < scene.gaussians.size(); ++n) {
    const auto id = static_cast<std::uint32_t>(scene.gaussians.plane(Gaussians::kSh)[n]);
    EXPECT_TRUE(place.emplace(id, n).second) << "twice: " << id;
  }
  size_t several = 0;
  size_t in_no_slab = 0;
  for (const auto& [id, shown] : versions) {
    ASSERT_TRUE(place.contains(id)) << id;
    const size_t n = place.at(id);
    const Version expected = chosen(shown, all.states.spacing);
    EXPECT_EQ(scene.layers[n], expected.state) << id;
    const Gaussians& state = all.each[scene.layers[n]].gaussians;
    for (int p = 0; p < scene.gaussians.planes(); ++p) {
      ASSERT_EQ(scene.gaussians.plane(p)[n], state.plane(p)[expected.index]) << id << ", " << p;
    }
    several += std::ranges::count_if(shown, &Version::in_slab) > 1 ? 1 : 0;
    in_no_slab += expected.in_slab ? 0 : 1;
  }
  // The model is one that can go wrong.
  EXPECT_GT(several, 3u);
  EXPECT_GT(in_no_slab, 20u);
  EXPECT_EQ(baked.statistics.from_nearest, in_no_slab);
  EXPECT_EQ(baked.statistics.from_slab, versions.size() - in_no_slab);

  // Beyond those only what the uncut scene alone shows, unchanged.
  size_t uncut = 0;
  for (std::uint32_t id = 0; id < 2000; ++id) {
    const bool visible = model_.scene.gaussians.opacity(id) >= 1.0f / 255;
    EXPECT_EQ(place.contains(id), visible) << id;
    if (visible && !versions.contains(id)) {
      ++uncut;
      EXPECT_EQ(scene.gaussians.mean(place.at(id)), model_.scene.gaussians.mean(id));
    }
  }
  EXPECT_GT(uncut, 5u);
  EXPECT_EQ(baked.statistics.from_uncut, uncut);
}

TEST_P(Bake, CountsAddUp) {
  const AllStates all = make_all(model_);
  const BakedScene baked = bake(model_, kStates);
  const BakeStatistics& s = baked.statistics;
  ASSERT_EQ(s.states.size(), static_cast<size_t>(kStates));
  size_t from_slab = 0;
  size_t in_slab = 0;
  for (const StateStatistics& state : s.states) {
    from_slab += state.from_slab;
    in_slab += state.in_slab;
    EXPECT_LE(state.from_slab, state.in_slab);
    EXPECT_LE(state.in_slab, state.shown);
  }
  EXPECT_EQ(from_slab, s.from_slab);
  EXPECT_EQ(baked.scene.gaussians.size(), s.kept());
  EXPECT_EQ(s.raw_bytes, 23u * 2000 * 104);  // 26 floats at degree 1
  EXPECT_EQ(s.shared_sh_bytes, 23u * 2000 * 56 + 2000 * 36);
  EXPECT_EQ(s.slab_bytes, in_slab * 56 + s.from_slab * 36);
  EXPECT_EQ(s.consolidated_bytes, s.kept() * 94);
}

TEST_P(Bake, SameBytesAtAnyThreadCount) {
  set_thread_count(1);
  const Scene one = bake(model_, kStates).scene;
  set_thread_count(2);
  const Scene two = bake(model_, kStates).scene;
  set_thread_count(0);
  EXPECT_EQ(one.gaussians.data(), two.gaussians.data());
  EXPECT_EQ(one.layers, two.layers);
}

TEST_P(Bake, KeepsWhatTheSceneIs) {
  const Scene scene = bake(model_, kStates).scene;
  EXPECT_EQ(scene.title, model_.scene.title);
  EXPECT_EQ(scene.extent, model_.scene.extent);
  EXPECT_EQ(scene.axis, model_.scene.axis);
  EXPECT_EQ(scene.sphere.radius, model_.scene.sphere.radius);
  EXPECT_EQ(scene.bounds.min, model_.scene.bounds.min);
  EXPECT_EQ(scene.states.count, kStates);
  EXPECT_EQ(scene.states.keeps_below, std::get<1>(GetParam()));
}

TEST(ChooseStates, SlabsFillTheExtent) {
  for (const bool below : {true, false}) {
    const UniaxialModel model = random_model(1, 0, 0.08f, below);
    const PlaneStates states = choose_states(model, 40);
    const Vec2 extent = model.scene.extent;
    EXPECT_EQ(states.keeps_below, below);
    for (int i = 0; i < 1000; ++i) {  // every place lies in one slab
      const float position =
          extent.x + (extent.y - extent.x) * (static_cast<float>(i) + 0.5f) / 1000;
      int slabs = 0;
      for (int k = 0; k < 40; ++k) {
        const float d = position - states.position(k);
        if ((Slab{states.spacing}.holds(below ? -d : d))) {
          ++slabs;
          EXPECT_EQ(states.nearest_slab(position), k);
        }
      }
      EXPECT_EQ(slabs, 1) << position;
    }
    // One end is uncut, the other shows a slab.
    EXPECT_NEAR(states.position(below ? 39 : 0), below ? extent.y : extent.x, 1e-3f);
  }
}

TEST(ChooseStates, SaysWhatIsWrong) {
  UniaxialModel model = random_model(3, 0, 0.08f);
  EXPECT_THAT([&] { choose_states(model, 1); }, ThrowsMessage<Error>(HasSubstr("2 to 65536")));
  EXPECT_THROW(choose_states(model, kMaxStates + 1), Error);
  UniaxialModel flat = model;
  flat.scene.extent.y = flat.scene.extent.x;
  EXPECT_THAT([&] { choose_states(flat, 5); }, ThrowsMessage<Error>(HasSubstr("extent")));
  model.parameters.normal = Vec3(1, 0, 0);
  EXPECT_THAT([&] { bake(model, 5); }, ThrowsMessage<Error>(HasSubstr("across the axis")));
}

TEST_P(Bake, ADeepSlabTakesWhatThePlaneIsFarFrom) {
  constexpr float kDepth = 0.1f;  // beyond the narrower window
  const BakedScene baked = bake(model_, kStates, kDepth);
  const Scene& scene = baked.scene;
  EXPECT_EQ(scene.gaussians.size(), bake(model_, kStates).scene.gaussians.size());
  size_t unchanged = 0;
  for (size_t n = 0; n < scene.gaussians.size(); ++n) {
    const Vec3 mean = scene.gaussians.mean(n);
    const auto id = static_cast<size_t>(scene.gaussians.plane(Gaussians::kSh)[n]);
    unchanged += mean == model_.scene.gaussians.mean(id) ? 1 : 0;
    // By layers, a splat is switched where it lies, not where the state cuts that it comes from.
    EXPECT_EQ(scene.layers[n], scene.states.nearest_slab(glm::dot(scene.axis, mean)));
  }
  EXPECT_GT(baked.statistics.from_slab, 1000U);
  if (std::get<0>(GetParam()) > 0) {
    EXPECT_GT(unchanged, baked.statistics.from_slab * 99 / 100);
  }
}

TEST(Consolidator, TakesTheFirstOfEquals) {
  // Planes at 1 and 2 that keep what lies below; a centre right between their slabs' middles, which
  // neither slab holds in its own state.
  const PlaneStates states{2, 1, 1, true};
  Scene scene;
  scene.gaussians = Gaussians(1, 0);
  Consolidator consolidator(1, scene.axis, states);
  const std::vector<std::uint32_t> ids = {0};
  Gaussians version(1, 0);
  version.plane(2)[0] = 1.25f;  // 0.25 mm beyond plane 1
  consolidator.add(0, version, ids);
  version.plane(2)[0] = 0.75f;  // 0.25 mm below the slab of plane 2
  consolidator.add(1, version, ids);
  const BakedScene baked = consolidator.finish(scene);
  ASSERT_EQ(baked.scene.layers, std::vector<std::uint16_t>{0});
  EXPECT_EQ(baked.scene.gaussians.mean(0).z, 1.25f);
  EXPECT_EQ(baked.statistics.from_nearest, 1u);
}

}  // namespace
}  // namespace clipgs
