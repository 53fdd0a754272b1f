#include "section/section.h"

#include <cmath>
#include <gtest/gtest.h>

#include "cinema/test_scenes.h"
#include "core/error.h"
#include "core/random.h"

namespace clipgs {
namespace {

using test::make_preset;
using test::make_volume;
using test::point;

/// A body of CT-like values, air around it and in a cavity within.
Volume make_body(int size) {
  const Vec3 middle(0.5f * static_cast<float>(size - 1));
  return make_volume(IVec3(size), [&](const IVec3& at) {
    const float r = glm::length(Vec3(at) - middle) / static_cast<float>(size);
    if (r > 0.4f) {
      return -1000.0f - static_cast<float>(at.x % 3);  // noise of a scanner
    }
    return r < 0.12f ? -850.0f : 40 + 200 * (r - 0.25f) + static_cast<float>(at.z % 2);
  });
}

Preset tissue() { return make_preset({point(-300, 0), point(-200, 4)}, test::white_sky()); }

TEST(ValueCurve, CodeAndValueAreInverse) {
  std::vector<float> values;
  for (int i = 0; i < 256; ++i) {
    values.push_back(-1000 + 0.03f * static_cast<float>(i * i));
  }
  const ValueCurve curve(values);
  for (float code = 0; code <= 255; code += 0.37f) {
    EXPECT_NEAR(curve.code(curve.value(code)), code, 0.02f);
  }
  EXPECT_EQ(curve.code(-5000), 0);
  EXPECT_EQ(curve.code(5000), 255);
}

TEST(ValueCurve, RefusesOneThatDoesNotIncrease) {
  std::vector<float> values(256, 1.0f);
  EXPECT_THROW(ValueCurve{values}, Error);
  EXPECT_THROW(ValueCurve{std::vector<float>(3)}, Error);
}

TEST(ValueCurve, SpendsCodesWhereValuesAreCommonAndVisible) {
  ValueImportance importance{0, 1000, std::vector<double>(100, 1), std::vector<double>(100, 1)};
  importance.frequency[50] = 1000;    // values 500 … 510
  importance.sensitivity[20] = 1000;  // values 200 … 210
  const ValueCurve curve = fit_value_curve(importance, 16);
  EXPECT_EQ(curve.value(16), 0);
  EXPECT_LT(curve.value(0), 0);
  const auto codes_in = [&](float low, float high) { return curve.code(high) - curve.code(low); };
  EXPECT_GT(codes_in(500, 510), 4 * codes_in(800, 810));
  EXPECT_GT(codes_in(200, 210), 4 * codes_in(800, 810));
  EXPECT_GT(codes_in(800, 810), 0.2f);
}

TEST(Section, KeepsEveryVoxelWhereItIsAsFineAsTheVolume) {
  const Volume volume = make_body(40);
  const Section section = make_section(volume, tissue(), {64});
  EXPECT_EQ(section.spacing, volume.spacing);
  EXPECT_EQ(section.channels, 1);
  // A curve of 240 codes over −1002…70 HU: steps of about a unit where tissue is.
  const std::optional<Section::Reading> tissue_value =
      section.read(volume.world_from_index(Vec3(20, 20, 31)));
  EXPECT_NEAR(tissue_value->value, volume.at(20, 20, 31), 2);
  EXPECT_LT(tissue_value->error, 1);
  EXPECT_FALSE(section.read(volume.world_from_index(Vec3(1, 1, 1))));
  EXPECT_FALSE(section.read(Vec3(1000, 0, 0)));
  for (const IVec3 at : {IVec3(20, 20, 31), IVec3(10, 22, 19), IVec3(20, 20, 20)}) {
    const Vec3 index = section.index_from_world(volume.world_from_index(Vec3(at)));
    EXPECT_NEAR(section.value(section.sample(index)), volume.at(at.x, at.y, at.z), 4);
  }
}

TEST(Section, CoversTheMatterAtTheGivenSize) {
  const Volume volume = make_body(80);
  const Section section = make_section(volume, tissue(), {32});
  EXPECT_EQ(std::max({section.dims.x, section.dims.y, section.dims.z}), 32);
  for (const Vec3 corner : {Vec3(-0.4f), Vec3(0.4f)}) {
    const Vec3 index = section.index_from_world(corner * 79.0f / std::sqrt(3.0f));
    EXPECT_TRUE(glm::all(glm::greaterThan(index, Vec3(0))));
    EXPECT_TRUE(glm::all(glm::lessThan(index, Vec3(section.dims - 1))));
  }
  // Linear along the radius, so that averaging changes little but at the boundaries.
  const Vec3 inside = volume.world_from_index(Vec3(40, 40, 60));
  const Vec3 index = section.index_from_world(inside);
  EXPECT_NEAR(section.value(section.sample(index)), volume.sample(inside), 5);
}

TEST(Section, AirAroundTheBodyIsOneCodeAndAirInsideIsKept) {
  const Volume volume = make_body(40);
  const Section section = make_section(volume, tissue(), {64});
  EXPECT_EQ(section.voxels.front(), section.voxels[1]);
  const Vec3 cavity = section.index_from_world(volume.world_from_index(Vec3(20, 20, 20)));
  EXPECT_NEAR(section.value(section.sample(cavity)), -850, 4);
  EXPECT_EQ(section.voxels.front(), 0);
  for (const std::uint8_t code : section.voxels) {
    EXPECT_TRUE(code == 0 || code >= Section::kFirstInside);
  }
}

TEST(Section, KeepsWhatThePresetHides) {
  const Volume volume = make_body(40);
  const Preset dense = make_preset({point(60, 0), point(64, 4)}, test::white_sky());
  const Section section = make_section(volume, dense, {64});
  const Vec3 hidden = section.index_from_world(volume.world_from_index(Vec3(20, 20, 30)));
  EXPECT_LT(volume.at(20, 20, 30), 60);
  EXPECT_NEAR(section.value(section.sample(hidden)), volume.at(20, 20, 30), 4);
}

TEST(Section, TellsTheValuesAsScannedWhereThePicturesHaveOthers) {
  Volume volume = make_body(40);
  volume.scanned = volume.values;
  volume.values.transform([](float value) { return value > 0 ? 90.0f : value; });
  const Section section = make_section(volume, tissue(), {64});
  double squares = 0;
  int count = 0;
  for (int z = 8; z < 12; ++z) {
    for (int x = 16; x < 24; ++x) {
      const auto reading = section.read(volume.world_from_index(Vec3(x, 20, z)));
      ASSERT_TRUE(reading);
      const double error = reading->value - volume.scanned[volume.offset(x, 20, z)];
      squares += error * error;
      ++count;
    }
  }
  EXPECT_LT(std::sqrt(squares / count), 1);
  EXPECT_GT(volume.at(20, 20, 8) - volume.scanned[volume.offset(20, 20, 8)], 10);
}

/// An upsampled volume: its values are not the scanned ones' mean, so that it is told from them.
Volume finer(const Volume& scanned, const IVec3& factors) {
  Volume fine = make_volume((scanned.dims - 1) * factors + 1, [&](const IVec3& at) {
    return scanned.sample(scanned.world_from_index(Vec3(at) / Vec3(factors))) + 10;
  });
  fine.modality = scanned.modality;
  fine.spacing = scanned.spacing / Vec3(factors);
  fine.origin = scanned.origin;
  fine.upsampling = factors;
  return fine;
}

TEST(Section, IsOfTheVoxelsThatAreTraced) {
  const Volume scanned = make_body(40);
  const Volume traced = finer(scanned, {1, 2, 3});
  const Section section = make_section(traced, scanned, tissue(), {96});
  EXPECT_EQ(section.spacing, traced.spacing);
  EXPECT_EQ(section.source_spacing, scanned.spacing);
  const Vec3 between = traced.world_from_index(Vec3(20, 41, 94));
  const Vec3 at = section.index_from_world(between);
  EXPECT_LT(glm::length(at - glm::round(at)), 1e-3f);
  EXPECT_NEAR(section.value(section.sample(at)), traced.sample(between), 2);
  // Told is what is read of the scanned ones.
  const auto reading = section.read(scanned.world_from_index(Vec3(20, 20, 31)));
  ASSERT_TRUE(reading);
  EXPECT_NEAR(reading->value, scanned.at(20, 20, 31) + 10, 2);
  EXPECT_NEAR(reading->error, 10, 2);
}

TEST(Section, LeavesOutWhatLiesBetweenScannedVoxelsFirst) {
  const Volume scanned = make_body(40);
  const Volume traced = finer(scanned, {2, 4, 1});
  const size_t all = make_section(traced, scanned, tissue(), {128}).voxel_count();
  for (const int size : {64, 50, 40}) {
    const Section section = make_section(traced, scanned, tissue(), {size});
    EXPECT_LE(section.voxel_count(), static_cast<size_t>(size) * size * size);
    EXPECT_LT(section.voxel_count(), all);
    const Vec3 ratio = scanned.spacing / section.spacing;
    EXPECT_LT(glm::length(ratio - glm::round(ratio)), 1e-3f);
    const Vec3 at = section.index_from_world(scanned.world_from_index(Vec3(20, 20, 31)));
    EXPECT_LT(glm::length(at - glm::round(at)), 1e-3f);
  }
  const Section coarse = make_section(traced, scanned, tissue(), {20});
  EXPECT_LE(coarse.voxel_count(), 8000U);
  EXPECT_GT(coarse.voxel_count(), 6000U);
}

TEST(Section, GivesBackToFinerVoxelsWhatPicturesAreWithout) {
  Volume scanned = make_body(40);
  const Volume traced = finer(scanned, {2, 2, 2});
  scanned.scanned = scanned.values;
  scanned.values.transform([](float value) { return value - 25; });
  const Section section = make_section(traced, scanned, tissue(), {96});
  const Vec3 between = traced.world_from_index(Vec3(41, 40, 61));
  EXPECT_NEAR(section.value(section.sample(section.index_from_world(between))),
              traced.sample(between) + 25, 2);
}

TEST(Section, ResizedCoversTheSameBoxAndSaysWhatIsLost) {
  const Volume volume = make_body(60);
  const Section fine = make_section(volume, tissue(), {64});
  const Section coarse = resize_section(fine, 24);
  EXPECT_EQ(std::max({coarse.dims.x, coarse.dims.y, coarse.dims.z}), 24);
  const Vec3 corner = fine.world_from_index(Vec3(fine.dims - 1));
  EXPECT_LT(glm::length(coarse.world_from_index(Vec3(coarse.dims - 1)) - corner), 1e-3f);
  const size_t muscle = Section::error_band(fine.curve.code(60));
  EXPECT_GT(coarse.value_errors[muscle], fine.value_errors[muscle]);
  const Section again = make_section(volume, tissue(), {24});
  EXPECT_EQ(coarse.dims, again.dims);
  // Averaging codes is averaging values, but where the curve bends.
  EXPECT_LT(coarse.value_errors[muscle], 1.5f * again.value_errors[muscle]);
  EXPECT_EQ(resize_section(fine, 64).voxels, fine.voxels);
  EXPECT_THROW(resize_section(fine, 4), Error);
}

TEST(Section, EndsWhereTheVolumeDoesInMatter) {
  const Volume volume = make_volume(IVec3(30), [](const IVec3& at) {  // a column along z
    return glm::length(Vec3(at) - Vec3(14.5f, 14.5f, at.z)) < 8 ? 60.0f : -1000.0f;
  });
  const Section section = make_section(volume, tissue(), {64});
  const std::vector<Plane> ends = section.ends();
  ASSERT_EQ(ends.size(), 2U);
  for (const Plane& end : ends) {
    EXPECT_EQ(std::abs(end.normal.z), 1);
    EXPECT_NEAR(end.signed_distance(Vec3(0)), 14.5f, 1e-4f);
  }
  EXPECT_TRUE(make_section(make_body(40), tissue(), {64}).ends().empty());
}

TEST(Section, PhotographsKeepTheirColours) {
  Volume volume = make_body(24);
  volume.modality = Modality::kPhoto;
  volume.rgb.resize(volume.voxels() * 3);
  for (size_t i = 0; i < volume.voxels(); ++i) {
    const bool body = volume.values[i] > 0;
    volume.rgb[3 * i] = body ? 200 : 0;
    volume.rgb[3 * i + 1] = body ? 100 : 0;
    volume.rgb[3 * i + 2] = body ? 50 : 0;
    volume.values.unpack()[i] = body ? 117.65f : 0.0f;
  }
  const Preset preset = make_preset({point(20, 0), point(40, 4)}, test::white_sky());
  const Section section = make_section(volume, preset, {64});
  EXPECT_EQ(section.channels, 3);
  const Vec3 index = section.index_from_world(volume.world_from_index(Vec3(12, 12, 18)));
  EXPECT_EQ(section.sample(index), Vec3(200, 100, 50));
  EXPECT_NEAR(section.value(section.sample(index)), 117.65f, 0.1f);
}

TEST(Section, RefusesBadSizes) {
  const Volume volume = make_body(16);
  EXPECT_THROW(make_section(volume, tissue(), {4}), Error);
  EXPECT_THROW(make_section(volume, tissue(), {5000}), Error);
}

}  // namespace
}  // namespace clipgs
