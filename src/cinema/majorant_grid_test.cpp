#include "cinema/majorant_grid.h"

#include <gtest/gtest.h>

#include "cinema/test_scenes.h"
#include "core/random.h"

namespace clipgs {
namespace {

using test::make_volume;
using test::point;

Vec3 random_point(Rng& rng, const Vec3& size) {
  return Vec3(rng.uniform(), rng.uniform(), rng.uniform()) * size;
}

TEST(VoxelGrid, InterpolatesLikeTheVolume) {
  Rng rng(1);
  const Volume volume =
      make_volume({9, 7, 5}, [&](const IVec3&) { return 3000 * rng.uniform() - 1000; });
  const VoxelGrid grid(volume, -1000, 2000);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 voxel = random_point(rng, Vec3(volume.dims - 1));
    EXPECT_NEAR(grid.value(grid.sample(voxel)), volume.sample(volume.world_from_index(voxel)), 0.1);
  }
  // Beyond the edge, where gradients look, the edge goes on.
  EXPECT_FLOAT_EQ(grid.sample(-1, 3, 2), grid.sample(0, 3, 2));
  EXPECT_FLOAT_EQ(grid.sample(9, 3, 2), grid.sample(8, 3, 2));
}

TEST(VoxelGrid, OfPackedValuesIsTheSame) {
  Rng rng(4);
  const Volume volume = make_volume(
      {9, 7, 5}, [&](const IVec3&) { return std::floor(400 * rng.uniform()) * 7.3f - 1000; });
  Volume packed = volume;
  packed.values.pack();
  ASSERT_TRUE(packed.values.packed());
  const VoxelGrid one(volume, -900, 1500);
  const VoxelGrid two(packed, -900, 1500);
  for (int z = -1; z <= 6; ++z) {
    for (int y = -1; y <= 8; ++y) {
      for (int x = -1; x <= 10; ++x) {
        ASSERT_EQ(one.code(x, y, z), two.code(x, y, z));
      }
    }
  }
}

TEST(VoxelGrid, GradientOfAnInclinedPlane) {
  const Volume volume = make_volume(
      {12, 12, 12}, [](const IVec3& v) { return 3.0f * v.x - 2.0f * v.y + 5.0f * v.z; });
  const VoxelGrid grid(volume, -40, 100);
  const Vec3 gradient = grid.gradient(Vec3(5.3f, 6.1f, 4.7f)) * grid.step();
  EXPECT_NEAR(gradient.x, 3, 0.01);
  EXPECT_NEAR(gradient.y, -2, 0.01);
  EXPECT_NEAR(gradient.z, 5, 0.01);
}

// Clumps of values in air, and a transfer function that shows two separate bands of them.
struct GridFixture {
  Volume volume;
  TransferFunction transfer{
      {point(100, 0), point(150, 1), point(200, 0), point(500, 0), point(510, 3), point(520, 0)}};
  explicit GridFixture(std::uint64_t seed) {
    Rng rng(seed);
    std::array<Vec4, 5> clumps{};
    for (Vec4& clump : clumps) {
      clump = Vec4(random_point(rng, Vec3(50, 40, 60)), 2 + 5 * rng.uniform());
    }
    volume = make_volume({50, 40, 60}, [&](const IVec3& v) {
      for (const Vec4& c : clumps) {
        if (glm::length(Vec3(v) - Vec3(c)) < c.w) {
          return 1000 * rng.uniform();
        }
      }
      return 0.0f;
    });
  }
};

TEST(MajorantGrid, BoundsTheExtinctionEverywhere) {
  const GridFixture f(2);
  const VoxelGrid grid(f.volume, 0, 1000);
  const MajorantGrid majorants(grid, f.transfer, Vec3(1));
  Rng rng(5);
  int visible = 0;
  int air = 0;
  for (int i = 0; i < 200000; ++i) {
    const Vec3 voxel = random_point(rng, Vec3(f.volume.dims - 1));
    const IVec3 cell = IVec3(voxel / static_cast<float>(MajorantGrid::kCell));
    const float extinction = f.transfer.at(grid.value(grid.sample(voxel))).extinction;
    visible += extinction > 0 ? 1 : 0;
    ASSERT_LE(extinction, majorants.majorant(cell.x, cell.y, cell.z));
    const IVec3 low = IVec3(voxel);
    const bool has_matter = majorants.has_matter(low.x, low.y, low.z);
    ASSERT_TRUE(has_matter || extinction == 0);
    air += has_matter ? 0 : 1;
  }
  EXPECT_GT(visible, 500);
  EXPECT_GT(air, 100000);
}

TEST(MajorantGrid, IsLowerWhereLabelsThin) {
  Volume volume = make_volume({40, 8, 8}, [](const IVec3&) { return 1.0f; });
  volume.label_numbers = {0, 1, 2};
  for (size_t i = 0; i < volume.voxels(); ++i) {
    const size_t x = i % 40;
    volume.labels.push_back(x < 12 ? 0 : x < 24 ? 1 : 2);
  }
  LabelLooks looks;
  looks[1].opacity = 0.5f;
  looks[2].opacity = 0;
  const VoxelGrid grid(volume, 0, 1);
  const LabelGrid labels(volume, looks);
  const MajorantGrid majorants(grid, TransferFunction({point(0, 0), point(1, 2)}), Vec3(1),
                               &labels);
  EXPECT_GE(majorants.majorant(4, 1, 1), 2);
  EXPECT_GE(majorants.majorant(5, 1, 1), 2);  // its last voxel is a border of the next label
  EXPECT_NEAR(majorants.majorant(8, 1, 1), 1, 0.01);
  EXPECT_EQ(majorants.majorant(14, 1, 1), 0);
  EXPECT_FALSE(majorants.has_matter(24, 3, 3));
  EXPECT_TRUE(majorants.has_matter(23, 3, 3));
  EXPECT_EQ(majorants.occupied().max.x, 24);
  EXPECT_NEAR(labels.mean_opacity(Vec3(11.25f, 3, 3)), 0.875, 1e-6);
}

TEST(MajorantGrid, BoundsTheExtinctionThatGradientOpacityLeaves) {
  const GridFixture f(3);
  const VoxelGrid grid(f.volume, 0, 1000);
  const Vec3 spacing(0.7f, 1, 1.5f);
  const GradientOpacity thinning{200, 1200, 0};
  const MajorantGrid majorants(grid, f.transfer, spacing, nullptr, thinning);
  const MajorantGrid without(grid, f.transfer, spacing);
  Rng rng(6);
  int visible = 0;
  int lower = 0;
  for (int i = 0; i < 200000; ++i) {
    const Vec3 voxel = random_point(rng, Vec3(f.volume.dims - 1));
    const IVec3 cell = IVec3(voxel / static_cast<float>(MajorantGrid::kCell));
    const float steepness = glm::length(grid.gradient(voxel) * grid.step() / spacing);
    const float extinction =
        thinning.factor(steepness) * f.transfer.at(grid.value(grid.sample(voxel))).extinction;
    visible += extinction > 0 ? 1 : 0;
    const float bound = majorants.majorant(cell.x, cell.y, cell.z);
    ASSERT_LE(extinction, bound);
    lower += bound < without.majorant(cell.x, cell.y, cell.z) ? 1 : 0;
    const IVec3 low = IVec3(voxel);
    ASSERT_TRUE(majorants.has_matter(low.x, low.y, low.z) || extinction == 0);
  }
  EXPECT_GT(visible, 200);
  EXPECT_GT(lower, 200);
}

TEST(MajorantGrid, IsEmptyWhereGradientOpacityLeavesNothing) {
  const Volume volume =
      make_volume({40, 8, 8}, [](const IVec3& v) { return v.x < 20 ? 50.0f : 60.0f; });
  const VoxelGrid grid(volume, 0, 100);
  const MajorantGrid majorants(grid, TransferFunction({point(0, 2), point(100, 2)}), Vec3(1),
                               nullptr, GradientOpacity{2, 4, 0});
  EXPECT_EQ(majorants.occupied().min.x, 18);
  EXPECT_EQ(majorants.occupied().max.x, 22);
  EXPECT_TRUE(majorants.has_matter(18, 3, 3));
  EXPECT_FALSE(majorants.has_matter(21, 3, 3));
}

// The optical depth of the majorants along random rays, by the walk and by small steps.
TEST(MajorantGrid, WalkVisitsEveryCellOnce) {
  Rng rng(9);
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const GridFixture f(seed);
    const VoxelGrid grid(f.volume, 0, 1000);
    const MajorantGrid majorants(grid, f.transfer, Vec3(1));
    const Vec3 end = Vec3(f.volume.dims - 1);
    for (int i = 0; i < 200; ++i) {
      const Vec3 a = random_point(rng, end);
      const Vec3 b = i % 10 == 0 ? Vec3(a.x, a.y, end.z - a.z) : random_point(rng, end);
      const float length = glm::length(b - a);
      const Vec3 direction = (b - a) / length;
      float walked = 0;
      float last = 0;
      majorants.walk(a, direction, 0, length, [&](float majorant, float t0, float t1) {
        EXPECT_GE(t0, last);
        EXPECT_GT(t1, t0);
        EXPECT_LE(t1, length);
        last = t1;
        walked += majorant * (t1 - t0);
        return false;
      });
      constexpr int kSteps = 4000;
      double stepped = 0;
      for (int s = 0; s < kSteps; ++s) {
        const Vec3 p = glm::mix(a, b, (static_cast<float>(s) + 0.5f) / kSteps);
        const IVec3 cell = IVec3(p / static_cast<float>(MajorantGrid::kCell));
        stepped += static_cast<double>(majorants.majorant(cell.x, cell.y, cell.z));
      }
      stepped *= static_cast<double>(length) / kSteps;
      ASSERT_NEAR(walked, stepped, 0.05 + 0.01 * stepped);
    }
  }
}

TEST(MajorantGrid, EmptyCellsKnowHowFarTheNextMatterIs) {
  const GridFixture f(2);
  const VoxelGrid grid(f.volume, 0, 1000);
  const MajorantGrid majorants(grid, f.transfer, Vec3(1));
  const MajorantGrid::Cells& cells = majorants.cells();
  std::vector<IVec3> all;
  std::vector<IVec3> matter;
  for (int z = 0; z < cells.count.z; ++z) {
    for (int y = 0; y < cells.count.y; ++y) {
      for (int x = 0; x < cells.count.x; ++x) {
        all.emplace_back(x, y, z);
        if (majorants.majorant(x, y, z) > 0) {
          matter.emplace_back(x, y, z);
        }
      }
    }
  }
  ASSERT_GT(matter.size(), 50U);
  for (const IVec3& cell : all) {
    int nearest = 255;
    for (const IVec3& other : matter) {
      const IVec3 d = glm::abs(cell - other);
      nearest = std::min(nearest, std::max({d.x, d.y, d.z}));
    }
    const auto word =
        cells
            .words[static_cast<size_t>(cell.x + cell.y * cells.stride_y + cell.z * cells.stride_z)];
    const auto bound =
        std::bit_cast<float>(word & static_cast<std::uint32_t>(MajorantGrid::kBoundBits));
    ASSERT_EQ(std::max(0.0f, -bound), static_cast<float>(nearest));
  }
}

TEST(MajorantGrid, StopsWhenTold) {
  const Volume volume = make_volume({40, 8, 8}, [](const IVec3&) { return 1.0f; });
  const VoxelGrid grid(volume, 0, 1);
  const MajorantGrid majorants(grid, TransferFunction({point(0, 0), point(1, 2)}), Vec3(1));
  int visits = 0;
  EXPECT_TRUE(majorants.walk(Vec3(0, 3, 3), Vec3(1, 0, 0), 0, 39,
                             [&](float, float, float) { return ++visits == 2; }));
  EXPECT_EQ(visits, 2);
}

TEST(MajorantGrid, OccupiedBoxHoldsTheMatter) {
  const Volume volume = make_volume(
      {64, 32, 32}, [](const IVec3& v) { return v == IVec3(40, 10, 20) ? 1.0f : 0.0f; });
  const VoxelGrid grid(volume, 0, 1);
  const MajorantGrid majorants(grid, TransferFunction({point(0.2f, 0), point(1, 2)}), Vec3(1));
  const Box box = majorants.occupied();
  EXPECT_LE(box.min.x, 39);
  EXPECT_GE(box.max.x, 41);
  EXPECT_LE(box.size().x, 2 * MajorantGrid::kCell);
  const MajorantGrid nothing(grid, TransferFunction({point(2, 0), point(3, 2)}), Vec3(1));
  EXPECT_TRUE(nothing.occupied().empty());
}

}  // namespace
}  // namespace clipgs
