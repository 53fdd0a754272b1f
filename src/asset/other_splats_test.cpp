#include "asset/other_splats.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asset/case.h"
#include "asset/spz.h"
#include "core/error.h"
#include "core/file.h"
#include "splat/ply.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using ::testing::HasSubstr;

/// A row of splats from 0 to 1 m to the right, and one far off.
Gaussians row() {
  Gaussians splats(1001, 0);
  for (size_t i = 0; i < splats.size(); ++i) {
    splats.plane(Gaussians::kMean)[i] = i == 1000 ? 900.0f : static_cast<float>(i) / 1000;
    splats.plane(Gaussians::kRotation)[i] = 1;
    splats.plane(Gaussians::kLogScale)[i] = -6;
  }
  return splats;
}

TEST(OtherSplats, LieAsTheyAreTakenToAndWithoutTheFarthest) {
  const Scene scene = scene_of_splats(row());
  EXPECT_NEAR(scene.bounds.min.x, -995, 10);  // the patient's right is on the left
  EXPECT_NEAR(scene.bounds.max.x, -5, 10);
  EXPECT_NEAR(scene.sphere.radius, 500, 10);
  EXPECT_EQ(scene.axis, Vec3(0, 0, 1));
  EXPECT_THROW(scene_of_splats(Gaussians()), Error);
}

TEST(OtherSplats, AreReadFromPlyAndSpzWithAWord) {
  const TestFolder folder;
  write_ply(folder / "a.ply", row());
  const Bytes spz = encode_spz(row());
  write_file(folder / "a.spz", spz.data(), spz.size());
  for (const char* name : {"a.ply", "a.spz"}) {
    ::testing::internal::CaptureStderr();
    const Case contents = load_case(folder / name);
    EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("metres, y down"));
    EXPECT_EQ(contents.scene.gaussians.size(), 1001);
    EXPECT_NEAR(contents.scene.sphere.radius, 500, 10);
    EXPECT_FALSE(contents.section);
  }
}

}  // namespace
}  // namespace clipgs
