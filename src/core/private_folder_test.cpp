#include "core/private_folder.h"

#include <chrono>
#include <csignal>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "core/file.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

/// Waits a while for it to vanish.
bool vanishes(const fs::path& path) {
  for (int i = 0; i < 500 && fs::exists(path); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return !fs::exists(path);
}

TEST(PrivateFolder, IsItsOwnersAloneAndGoesWithTheObject) {
  fs::path path;
  {
    const PrivateFolder folder;
    path = folder.path();
    EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_all);
    fs::create_directory(path / "in");
    write_text(path / "in" / "file", "something");
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST(PrivateFolder, GoesWithTheProcessHoweverThatEnds) {
  for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
    std::array<int, 2> told{};
    ASSERT_EQ(::pipe(told.data()), 0);
    const pid_t process = ::fork();
    if (process == 0) {
      ::setpgid(0, 0);
      const PrivateFolder folder;
      write_text(folder.path() / "file", "something");
      const std::string path = folder.path().string();
      (void)!::write(told[1], path.data(), path.size());
      ::pause();
      std::_Exit(1);
    }
    std::array<char, 256> name{};
    ASSERT_GT(::read(told[0], name.data(), name.size() - 1), 0);
    ASSERT_TRUE(fs::exists(fs::path(name.data()) / "file"));
    // SIGKILL reaches one process, the others all of a terminal's.
    ::kill(signal == SIGKILL ? process : -process, signal);
    ::waitpid(process, nullptr, 0);
    EXPECT_TRUE(vanishes(name.data())) << signal;
    ::close(told[0]);
    ::close(told[1]);
  }
}

}  // namespace
}  // namespace clipgs
