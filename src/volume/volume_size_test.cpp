#include "volume/volume_size.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "core/error.h"
#include "volume/load.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kGiB = std::uint64_t{1} << 30;

TEST(VolumeSize, StoredIn16BitsTakesTwoBytesAVoxel) {
  EXPECT_EQ((VolumeSize{IVec3(1024), 2}.loaded()), 2 * kGiB);
  EXPECT_EQ((VolumeSize{IVec3(1024), 1}.loaded()), 2 * kGiB);
  EXPECT_EQ((VolumeSize{IVec3(1024), 4}.loaded()), 4 * kGiB);
  EXPECT_EQ((VolumeSize{IVec3(1024), 2, false, true}.loaded()), 3 * kGiB);
  EXPECT_EQ((VolumeSize{IVec3(1024), 1, true}.loaded()), 7 * kGiB);
  EXPECT_EQ((VolumeSize{IVec3(1024), 2}.loading()), 4 * kGiB);
  EXPECT_EQ((VolumeSize{IVec3(1024), 2, false, false, true}.loaded()), 4 * kGiB);
  EXPECT_EQ((VolumeSize{IVec3(1024), 2, false, false, true}.loading()), 6 * kGiB);
  EXPECT_EQ((VolumeSize{IVec3(1024), 2, false, true}.loading()), 6 * kGiB);
  EXPECT_EQ((VolumeSize{IVec3(1024), 2, false, true, true}.loading()), 8 * kGiB);
}

TEST(VolumeSize, UpTo4GiVoxelsWithTheBorderAreSupported) {
  const auto supported = [](const IVec3& dims) {
    try {
      require_supported({dims}, "v.nii");
      return true;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("2^32"));
      return false;
    }
  };
  EXPECT_TRUE(supported({2045, 2045, 1021}));  // 2^32 with the border
  EXPECT_FALSE(supported({2045, 2045, 1022}));
  EXPECT_FALSE(supported(IVec3(std::numeric_limits<int>::max() / 4)));
}

TEST(VolumeSize, LackOfMemoryIsSaidWithWhatToDo) {
  const VolumeSize size{IVec3(1024), 2};
  EXPECT_EQ(lack_of_memory(size, 3 * kGiB, 5 * kGiB), "");
  const std::string lack = lack_of_memory(size, 3 * kGiB, 5 * kGiB - 1);
  EXPECT_THAT(lack, HasSubstr("1024 x 1024 x 1024 voxels need 5.4 GB of memory, 5.4 GB are free"));
  EXPECT_THAT(lack, HasSubstr("crop or downsample"));
  EXPECT_THAT(lack, HasSubstr("0.7 GB are enough"));
  // Loading may take more than the work.
  EXPECT_THAT(lack_of_memory(size, 0, 3 * kGiB), HasSubstr("need 4.3 GB"));
}

/// 60 cubed, far smaller than the work that it is loaded for.
void save_ramp(const std::filesystem::path& path) {
  Volume volume;
  volume.dims = IVec3(60);
  std::vector<float> values(volume.voxels());
  for (size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<float>(i % 1000);
  }
  volume.values = std::move(values);
  save_volume(path, volume);
}

TEST(VolumeSize, IsCheckedBeforeVoxelsAreRead) {
  const TestFolder folder;
  for (const char* name : {"v.nii.gz", "v.nrrd", "v.mha"}) {
    save_ramp(folder / name);
    // Without its voxels: whoever reads them says something else.
    std::filesystem::resize_file(folder / name, std::filesystem::file_size(folder / name) - 100);
    LoadOptions options;
    VolumeSize seen;
    options.work = [&](const VolumeSize& size) {
      seen = size;
      return std::uint64_t{1} << 62;
    };
    try {
      load_volume(folder / name, options);
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(name));
      EXPECT_THAT(error.what(), HasSubstr("60 x 60 x 60 voxels need 4611686018.4 GB of memory"));
    }
    EXPECT_EQ(seen.dims, IVec3(60));
    EXPECT_EQ(seen.stored_bytes, 2);
  }
}

TEST(VolumeSize, OfWhatACropLeavesIsCheckedAgain) {
  const TestFolder folder;
  save_ramp(folder / "v.nrrd");
  LoadOptions options;
  options.prepare.crop = Box{Vec3(10), Vec3(29)};
  std::vector<IVec3> seen;
  std::uint64_t needed = 0;
  options.work = [&](const VolumeSize& size) {
    seen.push_back(size.dims);
    return size.dims == IVec3(60) ? 0 : needed;
  };
  EXPECT_EQ(load_volume(folder / "v.nrrd", options).dims, IVec3(20));
  EXPECT_THAT(seen, testing::ElementsAre(IVec3(60), IVec3(20)));
  needed = std::uint64_t{1} << 62;
  EXPECT_THROW(load_volume(folder / "v.nrrd", options), Error);
}

TEST(VolumeSize, IsOnlyWarnedOfWhereTheCallerWantsThat) {
  const TestFolder folder;
  save_ramp(folder / "v.nii.gz");
  LoadOptions options;
  options.work = [](const VolumeSize&) { return std::uint64_t{1} << 62; };
  options.warn_of_size = true;
  testing::internal::CaptureStderr();
  EXPECT_EQ(load_volume(folder / "v.nii.gz", options).dims, IVec3(60));
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("to draw it, 60 x 60 x 60"));
}

}  // namespace
}  // namespace clipgs
