#include "volume/dicom_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "volume/dicom_fixture.h"
#include "volume/load.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

FixtureSlice slice_of(const std::string& series_uid) {
  FixtureSlice slice;
  slice.series_uid = series_uid;
  return slice;
}

/// Keeps the first `length` bytes.
void cut(const fs::path& file, size_t length) {
  const std::vector<std::uint8_t> whole = read_file(file);
  ASSERT_LT(length, whole.size());
  write_file(file, whole.data(), length);
}

Volume load_and_listen(const fs::path& path, std::string& warnings,
                       const LoadOptions& options = {}) {
  testing::internal::CaptureStderr();
  Volume volume = load_volume(path, options);
  warnings = testing::internal::GetCapturedStderr();
  return volume;
}

constexpr size_t kBeforeTheSeriesUid = 200;  // bytes
constexpr size_t kWithinThePixels = 900;

TEST(DicomStudy, OneFileReadsItsOwnSeriesFromItsOwnFolder) {
  const TestFolder folder;
  write_series(folder / "ct", even_table(6, 2), slice_of("1.2.1"), "a");
  write_series(folder / "ct", even_table(9, 2), slice_of("1.2.2"), "b");
  write_series(folder / "ct" / "more", even_table(9, 2), slice_of("1.2.1"), "c");
  write_series(folder / "sibling", even_table(9, 2), slice_of("1.2.1"), "d");
  std::string warnings;
  EXPECT_EQ(load_and_listen(folder / "ct" / "a7", warnings).dims, IVec3(16, 12, 6));
  EXPECT_EQ(warnings, "");
  EXPECT_EQ(load_and_listen(folder / "ct" / "b7", warnings).dims, IVec3(16, 12, 9));
  EXPECT_EQ(warnings, "");
}

TEST(DicomStudy, ADamagedFileElsewhereStopsNothing) {
  const TestFolder folder;
  write_series(folder / "ct", even_table(6, 2), slice_of("1.2.1"));
  write_series(folder / "other", even_table(2, 2), slice_of("1.2.2"), "o");
  cut(folder / "other" / "o0", kBeforeTheSeriesUid);
  write_series(folder / "ct", even_table(2, 2), slice_of("1.2.3"), "same");
  cut(folder / "ct" / "same7", kWithinThePixels);
  std::string warnings;
  EXPECT_EQ(load_and_listen(folder / "ct" / "i7", warnings).dims, IVec3(16, 12, 6));
  EXPECT_THAT(warnings, HasSubstr("left out 1 file(s) of other series that cannot be read"));
  EXPECT_EQ(load_and_listen(folder.path(), warnings).dims, IVec3(16, 12, 6));
  EXPECT_THAT(warnings, HasSubstr("left out 2 file(s) of other series that cannot be read"));
}

TEST(DicomStudy, ADamagedSliceOfTheSeriesIsAnError) {
  const TestFolder folder;
  write_series(folder.path(), even_table(20, 2), slice_of("1.2.1"));
  for (const size_t length : {kWithinThePixels, kBeforeTheSeriesUid}) {
    cut(folder / "i14", length);
    for (const fs::path& path : {folder.path(), folder / "i7"}) {
      EXPECT_THAT(error_of([&] { load_volume(path); }),
                  testing::AllOf(HasSubstr("i14: truncated"), HasSubstr("take it away")));
    }
  }
  EXPECT_THAT(error_of([&] { load_volume(folder / "i14"); }), HasSubstr("i14: truncated"));
  fs::remove(folder / "i14");
  std::string warnings;
  EXPECT_EQ(load_and_listen(folder.path(), warnings).dims.z, 20);
  EXPECT_THAT(warnings, HasSubstr("slice 3 (at -16.00 mm)"));
}

}  // namespace
}  // namespace clipgs
