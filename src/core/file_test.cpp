#include "core/file.h"

#include <csignal>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/error.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

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

TEST_F(FileTest, FullDiskThrowsAndLeavesNothing) {
  // A limit on the length of files stands for a disk that is full after the first bytes.
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit little{16, before.rlim_max};
  const auto ignored = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &little), 0);
  EXPECT_THAT([&] { write_text(folder_ / "out.bin", std::string(1000, 'x')); },
              ThrowsMessage<Error>(HasSubstr("out.bin")));
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, ignored);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(FileTest, WhatIsNoFileIsRefusedAndStays) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  fs::create_symlink("/dev/full", folder_ / "link");
  fs::create_symlink("loop", folder_ / "loop");
  for (const auto& [path, kind] : {std::pair<fs::path, const char*>{pipe, "is a pipe"},
                                   {"/dev/full", "is a device"},
                                   {folder_ / "link", "is a device"},
                                   {folder_ / "loop", "leads nowhere"},
                                   {folder_, "is a folder"}}) {
    EXPECT_THAT([&] { write_text(path, "x"); }, ThrowsMessage<Error>(HasSubstr(kind)));
    EXPECT_THAT([&] { require_writable(path); }, ThrowsMessage<Error>(HasSubstr(kind)));
  }
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
}

TEST_F(FileTest, LinksStayAndTheirTargetsAreWritten) {
  fs::create_directories(folder_ / "there");
  fs::create_symlink("there/a.txt", folder_ / "a.txt");  // to what is not there yet
  fs::create_symlink(folder_ / "a.txt", folder_ / "b.txt");
  require_writable(folder_ / "b.txt");
  EXPECT_FALSE(fs::exists(folder_ / "there/a.txt"));
  for (const char* text : {"first", "second"}) {
    write_text(folder_ / "b.txt", text);
    EXPECT_TRUE(fs::is_symlink(folder_ / "a.txt"));
    EXPECT_TRUE(fs::is_symlink(folder_ / "b.txt"));
    EXPECT_EQ(read_text(folder_ / "there/a.txt"), text);
  }
}

TEST_F(FileTest, LeftoversOfKilledWritersAreSwept) {
  const auto put = [&](const std::string& name) { write_text(folder_ / name, "half of a file"); };
  put("case.sog.clipgs-123.part");
  put("case.json.clipgs-123-4.part");
  for (const char* name : {"case.sog.part1", "case.sog.part", "case.clipgs-x.part", "case.sog",
                           "other.sog.clipgs-123.part"}) {
    put(name);
  }
  // One that is still being written.
  put("case.sog.clipgs-77.part");
  const int writer = ::open((folder_ / "case.sog.clipgs-77.part").c_str(), O_WRONLY);
  ASSERT_EQ(::flock(writer, LOCK_EX), 0);
  const auto names = [&] {
    std::vector<std::string> result;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      result.push_back(entry.path().filename().string());
    }
    return result;
  };
  require_writable(folder_ / "case.sog");
  EXPECT_THAT(names(), testing::UnorderedElementsAre(
                           "case.sog.part1", "case.sog.part", "case.clipgs-x.part", "case.sog",
                           "other.sog.clipgs-123.part", "case.sog.clipgs-77.part"));
  ::close(writer);
  sweep_leftovers(folder_);
  EXPECT_THAT(names(), testing::UnorderedElementsAre("case.sog.part1", "case.sog.part",
                                                     "case.clipgs-x.part", "case.sog"));
}

TEST_F(FileTest, WritesBesideWhatAProcessOfTheSameNumberLeft) {
  const std::string left = "a.txt.clipgs-" + std::to_string(getpid()) + ".part";
  write_text(folder_ / left, "half");
  write_text(folder_ / "a.txt", "whole");
  EXPECT_EQ(read_text(folder_ / "a.txt"), "whole");
  EXPECT_EQ(read_text(folder_ / left), "half");
}

}  // namespace
}  // namespace clipgs
