#include "volume/crop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "volume/load.h"
#include "volume/phantom.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using testing::HasSubstr;

/// Every voxel differs; colours and labels say where they come from as well.
Volume numbered() {
  Volume volume;
  volume.dims = {6, 7, 8};
  volume.spacing = {1, 2, 3};
  volume.direction = glm::mat3_cast(glm::angleAxis(0.1f, glm::normalize(Vec3(1, 2, 1))));
  volume.origin = {10, -20, 30};
  std::vector<float> values;
  for (size_t i = 0; i < volume.voxels(); ++i) {
    values.push_back(static_cast<float>(i));
    volume.rgb.insert(volume.rgb.end(), 3, static_cast<std::uint8_t>(i % 251));
    volume.labels.push_back(static_cast<std::uint8_t>(i % 7));
  }
  volume.scanned = values;
  volume.values = std::move(values);
  return volume;
}

TEST(Crop, LeavesEveryVoxelWhereItIs) {
  for (const bool packed : {false, true}) {
    const Volume whole = numbered();
    Volume part = whole;
    if (packed) {
      part.values.pack();
    }
    crop(part, {{1, 2, 3}, {4, 3, 7}});
    ASSERT_EQ(part.dims, IVec3(4, 2, 5));
    for (int z = 0; z < 5; ++z) {
      for (int y = 0; y < 2; ++y) {
        for (int x = 0; x < 4; ++x) {
          const size_t from = whole.offset(x + 1, y + 2, z + 3);
          const size_t at = part.offset(x, y, z);
          ASSERT_EQ(part.values[at], whole.values[from]);
          ASSERT_EQ(part.scanned[at], whole.scanned[from]);
          ASSERT_EQ(part.rgb[3 * at + 2], whole.rgb[3 * from + 2]);
          ASSERT_EQ(part.labels[at], whole.labels[from]);
          EXPECT_LT(glm::length(part.world_from_index({x, y, z}) -
                                whole.world_from_index({x + 1, y + 2, z + 3})),
                    1e-4f);
        }
      }
    }
  }
}

TEST(Crop, ABoxInMmHoldsTheVoxelsWithin) {
  Volume volume = numbered();
  volume.direction = Mat3(1);
  const VoxelBox box = voxels_within(volume, {{11, -17, 0}, {13.5f, -11, 37}});
  EXPECT_EQ(box.low, IVec3(1, 2, 0));
  EXPECT_EQ(box.high, IVec3(3, 4, 2));
  EXPECT_EQ(voxels_within(volume, {{-1e9f, -1e9f, -1e9f}, {1e9f, 1e9f, 1e9f}}).dims(), volume.dims);
}

TEST(Crop, MatterIsFoundInNoise) {
  for (const bool ct : {true, false}) {
    Volume volume = ct ? make_ball(96, 20, 40, -1000) : make_ball(96, 20, 300, 0);
    volume.modality = ct ? Modality::kCt : Modality::kMr;
    Rng rng(3);
    for (float& value : volume.values.unpack()) {
      value += 20 * rng.normal();
    }
    volume.values.unpack()[volume.offset(2, 3, 4)] = 3000;  // a lone voxel is no matter
    const VoxelBox box = voxels_of_matter(volume);
    for (int axis = 0; axis < 3; ++axis) {
      // The ball, from 28 to 67, and 5 mm around it.
      EXPECT_NEAR(box.low[axis], 23, 2) << axis;
      EXPECT_NEAR(box.high[axis], 72, 2) << axis;
    }
  }
}

TEST(Crop, IsToldAndMayNotLeaveNothing) {
  const TestFolder folder;
  Volume ball = make_ball(48, 15, 40, -1000);
  save_volume(folder / "ball.nrrd", ball);
  LoadOptions options;
  options.prepare.crop = Box{{-10, -5, 0}, {10, 5, 100}};
  testing::internal::CaptureStderr();
  const LoadedVolume loaded = load_with_series(folder / "ball.nrrd", options);
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              HasSubstr("cropped to a box, 20 x 10 x 24 of 48 x 48 x 48 voxels"));
  ASSERT_EQ(loaded.prepared.size(), 1);
  EXPECT_EQ(loaded.prepared[0].name, "crop");
  EXPECT_NEAR(loaded.volume.sample({-3, 2, 8}), ball.sample({-3, 2, 8}), 1e-3f);

  options.prepare.crop = Box{{100, 100, 100}, {200, 200, 200}};
  const auto error = [&] { return error_of([&] { load_volume(folder / "ball.nrrd", options); }); };
  EXPECT_THAT(error(), HasSubstr("--crop leaves 0 x 0 x 0 voxels"));
  options.prepare.crop = Box{{20, 20, 20}, {23, 23, 23}};
  EXPECT_THAT(error(), HasSubstr("nothing but the value"));
}

}  // namespace
}  // namespace clipgs
