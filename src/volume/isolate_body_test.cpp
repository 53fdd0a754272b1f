#include "volume/isolate_body.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>

#include "volume/phantom.h"
#include "volume/shows_table.h"

namespace clipgs {
namespace {

constexpr float kAir = -1000;

struct Thing {
  std::function<bool(const Vec3&)> holds;  // of mm from the middle of the picture
  float hu;
};

/// Later things lie over earlier ones.
Volume scan(const std::vector<Thing>& things, IVec3 dims = {120, 90, 40},
            Vec3 spacing = {2, 2, 3}) {
  Volume volume;
  volume.dims = dims;
  volume.spacing = spacing;
  volume.modality = Modality::kCt;
  std::vector<float> values(volume.voxels(), kAir);
  for (int z = 0; z < volume.dims.z; ++z) {
    for (int y = 0; y < volume.dims.y; ++y) {
      for (int x = 0; x < volume.dims.x; ++x) {
        const Vec3 mm = (Vec3(x, y, z) - 0.5f * Vec3(volume.dims - 1)) * volume.spacing;
        for (const Thing& thing : things) {
          if (thing.holds(mm)) {
            values[volume.offset(x, y, z)] = thing.hu;
          }
        }
      }
    }
  }
  volume.values = std::move(values);
  return volume;
}

std::function<bool(const Vec3&)> tube(Vec2 centre, Vec2 radii) {
  return [=](const Vec3& p) { return glm::length((Vec2(p) - centre) / radii) < 1; };
}

std::function<bool(const Vec3&)> box(Vec3 low, Vec3 high) {
  return [=](const Vec3& p) {
    return glm::all(glm::lessThan(low, p)) && glm::all(glm::lessThan(p, high));
  };
}

/// A chest with thin walls, lungs with a vessel, an arm, and an ear-like flap.
std::vector<Thing> patient() {
  return {{tube({0, 0}, {70, 50}), 40},    {tube({-32, 5}, {26, 34}), -850},
          {tube({32, 5}, {26, 34}), -850}, {tube({35, 10}, {3, 3}), 50},
          {tube({95, -10}, {16, 16}), 30}, {box({-4, 48, -10}, {4, 68, 12}), 20}};
}

/// A table of two shells with foam between them, and a cable: none of it touches the patient.
std::vector<Thing> table() {
  return {{box({-110, -80, -100}, {110, -62, 100}), -50},
          {box({-106, -77, -100}, {106, -65, 100}), -950},
          {tube({-80, 60}, {3, 3}), 300}};
}

std::vector<Thing> both(std::vector<Thing> first, const std::vector<Thing>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

TEST(IsolateBody, TakesTheTableOffAndNothingElse) {
  Volume scanned = scan(both(table(), patient()));
  const Volume expected = scan(patient());
  const Volume alone = scan(table());
  const auto matter = std::ranges::count_if(alone.values.all(), [](float hu) { return hu > -300; });
  EXPECT_NEAR(isolate_body(scanned).removed, static_cast<double>(matter) * 2 * 2 * 3 / 1000, 1e-6);
  for (size_t i = 0; i < scanned.values.size(); ++i) {
    // Air far from the patient is -1024 HU after, near it what it was.
    ASSERT_EQ(std::max(scanned.values[i], kAir), expected.values[i]) << "voxel " << i;
  }
}

TEST(IsolateBody, OfATableThatTouchesThePatientOnlyTheTouchingPartStays) {
  Volume scanned = scan(both({{box({-110, -54, -100}, {110, -48, 100}), -50}}, patient()));
  isolate_body(scanned);
  const auto hu = [&](float x, float y) {
    return scanned.sample(
        scanned.world_from_index(Vec3(x, y, 0) / scanned.spacing + 0.5f * Vec3(scanned.dims - 1)));
  };
  EXPECT_EQ(hu(-90, -51), -1024);
  EXPECT_EQ(hu(60, -51), -1024);
  EXPECT_EQ(hu(0, -45), 40);
}

/// A limb of muscle with fat around it, and bone.
std::vector<Thing> leg() {
  return {{tube({-95, -10}, {22, 22}), -90},
          {tube({-95, -10}, {12, 12}), 50},
          {tube({-95, -10}, {4, 4}), 900}};
}

TEST(IsolateBody, AHeadHolderThatStaysIsTold) {
  Volume with_leg = scan(both(leg(), {{tube({0, 0}, {60, 50}), 40}}));
  EXPECT_EQ(isolate_body(with_leg).foreign, 0);
  // A block as thick as a limb, of one plastic with a harder shell.
  const std::vector<Thing> holder = {{box({-90, -86, -40}, {90, -62, 40}), 700},
                                     {box({-86, -82, -36}, {86, -66, 36}), 100}};
  Volume with_holder = scan(both(holder, {{tube({0, 0}, {60, 50}), 40}}));
  const Isolation isolation = isolate_body(with_holder);
  EXPECT_GT(isolation.foreign, 50);
  EXPECT_GT(with_holder.at(60, 9, 20), 0);  // it stays
}

TEST(IsolateBody, MoreBesideTheBodyThanItTakesOffIsTold) {
  std::vector<Thing> plates;
  for (int i = 0; i < 14; ++i) {
    const float y = -80 + 11.0f * static_cast<float>(i);
    plates.push_back({box({-110, y, -100}, {60, y + 5, 100}), 0});
  }
  Volume volume = scan(both(plates, {{tube({95, 0}, {20, 20}), 40}}));
  const VoxelValues before = volume.values;
  EXPECT_TRUE(isolate_body(volume).unsure);
  EXPECT_EQ(volume.values, before);
}

TEST(IsolateBody, LeavesWhatItCannotTellFromABody) {
  const auto unchanged = [](Volume volume) {
    const VoxelValues before = volume.values;
    EXPECT_EQ(isolate_body(volume).removed, 0);
    EXPECT_EQ(volume.values, before);
  };
  Volume mr = scan(both(table(), patient()));
  mr.modality = Modality::kMr;
  unchanged(mr);
  Volume without_air = scan(both(table(), patient()));
  without_air.values.transform([](float value) { return std::max(value, 0.0f); });
  unchanged(without_air);
  unchanged(scan(table()));
}

Volume fine_scan(const std::vector<Thing>& things) {
  return scan(things, {160, 180, 30}, {1, 1, 2});
}

/// Skin, skull and brain; a nose.
std::vector<Thing> head() {
  return {{tube({0, 0}, {60, 50}), 40},
          {tube({0, 0}, {52, 42}), 900},
          {tube({0, 0}, {44, 34}), 40},
          {box({-8, 48, -8}, {8, 66, 8}), 30}};
}

TEST(IsolateBody, TakesAThinShellOffThatTouchesTheHeadAndEnclosesAir) {
  // A U as wide as the head, of plastic as light as fat, open in front.
  const auto shell = [](const Vec3& p) {
    const bool within = glm::length(Vec2(p) / Vec2(63, 80)) < 1;
    return p.y < 0 && within && glm::length(Vec2(p) / Vec2(60, 77)) >= 1;
  };
  Volume scanned = fine_scan(both({{shell, -100}}, head()));
  const Volume before = scanned;
  const Volume expected = fine_scan(head());
  const Isolation isolation = isolate_body(scanned);
  int touching = 0;
  for (size_t i = 0; i < scanned.voxels(); ++i) {
    if (expected.values[i] > kLeastMatter) {
      ASSERT_EQ(scanned.values[i], before.values[i]) << i;
    } else {
      touching += scanned.values[i] > kLeastMatter ? 1 : 0;
    }
  }
  const double left_ml = touching * 2.0 / 1000;
  EXPECT_GT(isolation.removed, 30);
  EXPECT_LT(left_ml, 0.2 * isolation.removed);  // where it touches
}

TEST(IsolateBody, TakesACableOffTheSkinAndAPlateOffTheEar) {
  const std::vector<Thing> things = {{tube({15, 51}, {3, 3}), 400},
                                     {box({66, -50, -40}, {70, 20, 40}), 600},
                                     {box({58, -6, -12}, {66, 6, 12}), 20}};
  Volume scanned = fine_scan(both(things, head()));
  const Volume before = scanned;
  const Volume expected = fine_scan(both({things.back()}, head()));
  isolate_body(scanned);
  int bitten = 0;
  for (size_t i = 0; i < scanned.voxels(); ++i) {
    ASSERT_TRUE(scanned.values[i] <= kLeastMatter || expected.values[i] > kLeastMatter) << i;
    bitten += scanned.values[i] <= kLeastMatter && expected.values[i] > kLeastMatter ? 1 : 0;
  }
  // Of the ear what is blurred with the plate, 2 mm, and what makes its edge smooth.
  EXPECT_LE(bitten * 2.0 / 1000, 4.0 * 12 * 24 / 1000);
}

TEST(IsolateBody, MakesSkinOfWhatACableLeavesInIt) {
  // Pressed into the skin, and blurred.
  const std::vector<Thing> cable = {{tube({15, 49}, {4, 4}), 150}, {tube({15, 51}, {3, 3}), 400}};
  Volume scanned = fine_scan(both(head(), cable));
  const Volume before = scanned;
  isolate_body(scanned);
  const Vec3 middle = 0.5f * Vec3(scanned.dims - 1);
  double steps = 0;
  for (size_t i = 0; i < scanned.voxels(); ++i) {
    const IVec3 at(i % scanned.dims.x, i / scanned.dims.x % scanned.dims.y,
                   i / scanned.dims.x / scanned.dims.y);
    const Vec3 mm = (Vec3(at) - middle) * scanned.spacing;
    const float away = glm::distance(Vec2(mm), Vec2(15, 51));
    if (away < 6) {
      ASSERT_LT(scanned.values[i], 100) << mm.x << ' ' << mm.y;
    } else if (away > 10 && before.values[i] > kLeastMatter) {
      ASSERT_EQ(scanned.values[i], before.values[i]) << mm.x << ' ' << mm.y;
    }
    if (away < 6 && at.x > 0) {
      steps = std::max<double>(steps, std::abs(scanned.values[i] - scanned.values[i - 1]));
    }
  }
  EXPECT_LT(steps, 600);  // of 1,040 between skin and air
}

TEST(IsolateBody, LeavesBonesWithoutFleshWhole) {
  const std::vector<Thing> bones = {{tube({0, 0}, {60, 50}), 900},
                                    {tube({0, 0}, {45, 35}), kAir},
                                    {tube({0, 55.5f}, {4, 4}), 700}};
  Volume scanned = fine_scan(bones);
  const Volume before = scanned;
  isolate_body(scanned);
  for (size_t i = 0; i < scanned.voxels(); ++i) {
    ASSERT_TRUE(scanned.values[i] == before.values[i] || before.values[i] == kAir) << i;
  }
}

/// As a file that does not say what its values mean.
Volume unknown(Volume volume) {
  volume.values.transform([](float hu) { return std::round((hu + 1024) / 16); });
  volume.modality = Modality::kUnknown;
  return volume;
}

TEST(ShowsTable, OnlyWhereOneLies) {
  EXPECT_TRUE(shows_table(unknown(scan(both(table(), patient())))));
  EXPECT_FALSE(shows_table(unknown(scan(patient()))));
  EXPECT_FALSE(shows_table(unknown(scan(both(leg(), patient())))));
  EXPECT_FALSE(shows_table(unknown(make_phantom(96))));
}

TEST(IsolateBody, KeepsEveryVoxelOfThePhantom) {
  Volume volume = make_phantom(96);
  const VoxelValues before = volume.values;
  isolate_body(volume);
  for (size_t i = 0; i < before.size(); ++i) {
    ASSERT_TRUE(volume.values[i] == before[i] || before[i] < -900) << before[i];
  }
}

}  // namespace
}  // namespace clipgs
