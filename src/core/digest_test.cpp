#include "core/digest.h"

#include <gtest/gtest.h>
#include <numeric>

namespace clipgs {
namespace {

TEST(Digest, IsSha256) {
  // FIPS 180-4's examples.
  EXPECT_EQ(Digest().hex(), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(Digest().add_bytes("ab", 2).add_bytes("c", 1).hex(),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Digest, NeighboursAreNotTakenForEachOther) {
  EXPECT_NE(Digest().add("ab").add("c").hex(), Digest().add("a").add("bc").hex());
  EXPECT_NE(Digest().add(std::vector<float>{1, 2}).add(std::vector<float>{}).hex(),
            Digest().add(std::vector<float>{1}).add(std::vector<float>{2}).hex());
  EXPECT_NE(Digest().add(1.0f).hex(), Digest().add(1.0).hex());
  EXPECT_EQ(Digest().add(Vec3(1, 2, 3)).hex(), Digest().add(1.0f).add(2.0f).add(3.0f).hex());
}

TEST(Digest, LargeArraysCountToTheLastElementOnAnyNumberOfThreads) {
  std::vector<std::uint16_t> values((size_t{3} << 20) + 5);
  std::iota(values.begin(), values.end(), std::uint16_t{0});
  const std::string all = Digest().add(values).hex();
  set_thread_count(1);
  EXPECT_EQ(Digest().add(values).hex(), all);
  set_thread_count(0);
  for (const size_t changed : {size_t{0}, size_t{1} << 20, values.size() - 1}) {
    ++values[changed];
    EXPECT_NE(Digest().add(values).hex(), all);
    --values[changed];
  }
}

}  // namespace
}  // namespace clipgs
