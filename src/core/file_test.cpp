#include "core/file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

class FileTest : public testing::Test {
 protected:
  FileTest() : folder_(fs::path(testing::TempDir()) / fmt::format("clipgs-file-{}", getpid())) {
    fs::create_directories(folder_);
  }
  ~FileTest() override { fs::remove_all(folder_); }
  fs::path folder_;
};

TEST_F(FileTest, WritesAndReadsBack) {
  write_text(folder_ / "a.txt", "hello");
  write_text(folder_ / "a.txt", "again");
  EXPECT_EQ(read_text(folder_ / "a.txt"), "again");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);  // no temporary left
}

TEST_F(FileTest, MissingFileSaysWhere) {
  try {
    read_file(folder_ / "missing.bin");
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("missing.bin"), std::string::npos);
  }
}

TEST_F(FileTest, RefusesLongerThanLimit) {
  write_text(folder_ / "a.txt", "hello");
  EXPECT_THROW(read_file(folder_ / "a.txt", 4), Error);
}

TEST_F(FileTest, UnwritableFolderThrowsAndLeavesNothing) {
  EXPECT_THROW(write_text("/proc/clipgs.txt", "x"), Error);
  EXPECT_THROW(require_writable("/proc/clipgs.txt"), Error);
  EXPECT_THROW(create_folder("/proc/clipgs"), Error);
}

TEST_F(FileTest, FreeSpaceIsChecked) {
  EXPECT_NO_THROW(require_free_space(folder_, 1));
  try {
    require_free_space(folder_, std::uintmax_t{1} << 62);
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("needs 4611686018.43 GB"), std::string::npos) << e.what();
  }
}

TEST_F(FileTest, FullDiskThrows) {
  // /dev/full answers every write with ENOSPC; a link to it stands for the temporary file.
  const fs::path target = folder_ / "out.bin";
  fs::create_symlink("/dev/full", target.string() + ".part" + std::to_string(getpid()));
  EXPECT_THROW(write_text(target, "x"), Error);
  EXPECT_FALSE(fs::exists(target));
}

}  // namespace
}  // namespace clipgs
