#include "core/lock.h"

#include <csignal>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <optional>
#include <sys/wait.h>
#include <unistd.h>

#include "core/error.h"
#include "core/file.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

class LockTest : public testing::Test {
 protected:
  LockTest() : folder_(fs::path(testing::TempDir()) / fmt::format("clipgs-lock-{}", getpid())) {}
  ~LockTest() override { fs::remove_all(folder_); }
  fs::path folder_;
};

TEST_F(LockTest, TheSecondIsToldWhoIsAtWork) {
  std::optional<FolderLock> first(folder_);
  EXPECT_THAT([&] { FolderLock second(folder_, "take another with --work"); },
              ThrowsMessage<Error>(AllOf(
                  HasSubstr(folder_.string()), HasSubstr(fmt::format("process {} on ", getpid())),
                  HasSubstr("(since 20"), HasSubstr("take another with --work"))));
  first.reset();
  EXPECT_NO_THROW(FolderLock{folder_});
}

TEST_F(LockTest, WorkThatCameToNothingLeavesNothing) {
  {
    const FolderLock lock(folder_);
  }
  EXPECT_FALSE(fs::exists(folder_));
  {
    const FolderLock lock(folder_);
    write_text(folder_ / "result", "x");
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
  fs::remove(folder_ / "result");
  {
    const FolderLock lock(folder_);
  }
  EXPECT_TRUE(fs::is_empty(folder_));  // it was there before
}

TEST_F(LockTest, VanishesWithAKilledProcess) {
  fs::create_directories(folder_);
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const FolderLock lock(folder_);
    if (::write(ready[1], "x", 1) == 1) {
      ::pause();
    }
    std::_Exit(0);
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_THAT([&] { FolderLock{folder_}; },
              ThrowsMessage<Error>(HasSubstr(fmt::format("process {} ", child))));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  write_text(folder_ / "scene.ply.clipgs-1.part", "half");
  EXPECT_NO_THROW(FolderLock{folder_});
  EXPECT_TRUE(fs::is_empty(folder_));  // swept as well
  ::close(ready[0]);
  ::close(ready[1]);
}

TEST_F(LockTest, AFolderThatCannotBeLockedFails) {
  EXPECT_THROW(FolderLock("/proc/clipgs"), Error);
  EXPECT_THROW(FolderLock("/proc/self"), Error);
}

}  // namespace
}  // namespace clipgs
