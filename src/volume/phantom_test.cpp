#include "volume/phantom.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/parallel.h"
#include "volume/histogram.h"

namespace clipgs {
namespace {

TEST(Phantom, SameSeedSameBytesAtAnyThreadCount) {
  set_thread_count(1);
  const Volume one = make_phantom(64, 3);
  set_thread_count(2);
  const Volume two = make_phantom(64, 3);
  set_thread_count(0);
  EXPECT_EQ(one.values, two.values);
  EXPECT_NE(one.values, make_phantom(64, 4).values);
}

TEST(Phantom, SizeIsTheLongestAxis) {
  const Volume volume = make_phantom(48);
  EXPECT_EQ(std::max({volume.dims.x, volume.dims.y, volume.dims.z}), 48);
  EXPECT_EQ(volume.values.size(), volume.voxels());
  EXPECT_THROW(make_phantom(4), Error);
}

TEST(Phantom, HoldsEveryTissue) {
  const Histogram h = histogram(make_phantom());
  EXPECT_GT(h.share_between(-1050, -950), 0.1f);   // air around it
  EXPECT_GT(h.share_between(-900, -700), 0.02f);   // lung
  EXPECT_GT(h.share_between(-130, -60), 0.05f);    // fat
  EXPECT_GT(h.share_between(20, 80), 0.05f);       // muscle and organs
  EXPECT_GT(h.share_between(200, 300), 0.002f);    // contrast, marrow
  EXPECT_GT(h.share_between(700, 2000), 0.002f);   // cortical bone
  EXPECT_LT(h.share_between(2000, 1e6f), 0.001f);  // nothing that no body has
}

}  // namespace
}  // namespace clipgs
