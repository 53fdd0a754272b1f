#include "volume/voxel_values.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace clipgs {
namespace {

/// `different` values, each often, in fractions that no integers hold.
std::vector<float> values_of(size_t count, size_t different) {
  std::vector<float> values(count);
  for (size_t i = 0; i < count; ++i) {
    values[i] = std::sin(static_cast<float>(i * 7919 % different)) * 1000;
  }
  return values;
}

TEST(VoxelValues, FewAreKeptIn16BitsAndUnchanged) {
  const std::vector<float> floats = values_of(200000, 4000);
  VoxelValues values = floats;
  values.pack();
  ASSERT_TRUE(values.packed());
  EXPECT_TRUE(values.floats().empty());
  ASSERT_EQ(values.size(), floats.size());
  EXPECT_EQ(values, VoxelValues(floats));
  EXPECT_EQ(values.range().min, std::ranges::min(floats));
  EXPECT_EQ(values.range().max, std::ranges::max(floats));
  EXPECT_EQ(values.unpack(), floats);
  EXPECT_FALSE(values.packed());
}

TEST(VoxelValues, SomeAreSetAndTheRestStays) {
  for (const size_t different : {size_t{1000}, size_t{65534}, size_t{90000}}) {
    std::vector<float> floats(200000);
    for (size_t i = 0; i < floats.size(); ++i) {
      floats[i] = static_cast<float>(i % different) * 0.25f;
    }
    VoxelValues values = floats;
    values.pack();
    const std::vector<size_t> places = {7, 70001, 199999, 12, 13};
    const std::vector<float> set = {0.125f, floats[5], 0.125f, -5000, -6000};
    values.set(places, set);
    for (size_t i = 0; i < places.size(); ++i) {
      floats[places[i]] = set[i];
    }
    EXPECT_EQ(values.packed(), different == 1000) << different;
    EXPECT_EQ(values, VoxelValues(floats));
  }
}

TEST(VoxelValues, Takes65536DifferentOnesAndNotOneMore) {
  std::vector<float> floats(70000);
  for (size_t i = 0; i < floats.size(); ++i) {
    floats[i] = static_cast<float>(i % 65536) * 0.25f;
  }
  VoxelValues values = floats;
  values.pack();
  EXPECT_TRUE(values.packed());
  EXPECT_EQ(values, VoxelValues(floats));
  floats.back() = -0.25f;
  values = floats;
  values.pack();
  EXPECT_FALSE(values.packed());
  EXPECT_EQ(values, VoxelValues(floats));
}

TEST(VoxelValues, WholeNumbersAndOthersAreToldApartByTheirBits) {
  const std::vector<float> floats = {0,      -0.0f,    65535,    65536,  -65535, -65536,
                                     -65537, 0.5f,     65535.5f, -0.25f, 1e-30f, 3e9f,
                                     -3e38f, 16777216, 0,        -0.0f};
  VoxelValues values = floats;
  values.pack();
  ASSERT_TRUE(values.packed());
  EXPECT_EQ(values.meaning().size(), floats.size() - 2);
  for (size_t i = 0; i < floats.size(); ++i) {
    EXPECT_EQ(values[i], floats[i]);
    EXPECT_EQ(std::signbit(values[i]), std::signbit(floats[i]));
  }
}

TEST(VoxelValues, ArePackedPieceByPieceUntilThereAreTooMany) {
  for (const size_t different : {size_t{1000}, size_t{90000}}) {
    const std::vector<float> floats = values_of(200000, different);
    ValuePacker packer(floats.size());
    for (size_t begin = 0; begin < floats.size(); begin += 10000) {
      packer.append(std::span(floats).subspan(begin, 10000));
    }
    const VoxelValues values = packer.take();
    EXPECT_EQ(values.packed(), different == 1000);
    EXPECT_EQ(values, VoxelValues(floats));
  }
}

TEST(VoxelValues, AreChangedAsFloatsWouldBe) {
  const std::vector<float> floats = values_of(100000, 3000);
  VoxelValues packed = floats;
  packed.pack();
  VoxelValues plain = floats;
  for (VoxelValues* values : {&packed, &plain}) {
    values->transform([](float value) { return std::max(2 * value + 1, -500.0f); });
    values->set_where(-1024, [](size_t i) { return i % 3 == 0; });
  }
  EXPECT_TRUE(packed.packed());
  EXPECT_EQ(packed, plain);
  EXPECT_EQ(packed[3], -1024);
  EXPECT_EQ(packed[4], std::max(2 * floats[4] + 1, -500.0f));
}

TEST(VoxelValues, AValueForWhichNoCodeIsLeft) {
  std::vector<std::uint16_t> codes(65536);
  std::vector<float> meaning(65536);
  for (size_t i = 0; i < codes.size(); ++i) {
    codes[i] = static_cast<std::uint16_t>(i);
    meaning[i] = static_cast<float>(i);
  }
  VoxelValues all(codes, meaning);
  all.set_where(-7, [](size_t i) { return i == 5; });
  EXPECT_FALSE(all.packed());
  EXPECT_EQ(all[5], -7);
  EXPECT_EQ(all[6], 6);
  // One code is not used: its meaning may change.
  codes[9] = 8;
  VoxelValues spare(codes, meaning);
  spare.set_where(-7, [](size_t i) { return i == 5; });
  EXPECT_TRUE(spare.packed());
  EXPECT_EQ(spare[5], -7);
  EXPECT_EQ(spare[9], 8);
  EXPECT_EQ(spare[65535], 65535);
}

TEST(VoxelValues, NotANumberStaysOne) {
  VoxelValues values = std::vector<float>{1, std::numeric_limits<float>::quiet_NaN(), 3};
  values.pack();
  EXPECT_EQ(values[0], 1);
  EXPECT_TRUE(std::isnan(values[1]));
  EXPECT_EQ(values[2], 3);
}

}  // namespace
}  // namespace clipgs
