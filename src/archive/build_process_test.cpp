#include "archive/build_process.h"

#include <chrono>
#include <csignal>
#include <gtest/gtest.h>
#include <thread>
#include <unistd.h>

#include "core/file.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

class BuildProcessTest : public ::testing::Test {
 protected:
  BuildProcessTest()
      : log_(fs::path(::testing::TempDir()) / ("clipgs-process-" + std::to_string(::getpid()))) {}
  ~BuildProcessTest() override { fs::remove(log_); }

  static int status_of(BuildProcess& process) {
    while (!process.status()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return *process.status();
  }

  fs::path log_;
};

TEST_F(BuildProcessTest, TellsHowItEndedAndWhatItSaid) {
  BuildProcess process({"/bin/sh", "-c", "echo out; echo err >&2; exit 3"}, log_);
  EXPECT_EQ(status_of(process), 3);
  EXPECT_EQ(read_text(log_), "out\nerr\n");
  BuildProcess killed({"/bin/sh", "-c", "kill -9 $$"}, log_);
  EXPECT_EQ(status_of(killed), 128 + SIGKILL);
  BuildProcess absent({"/no/such/program"}, log_);
  EXPECT_EQ(status_of(absent), 127);
}

TEST_F(BuildProcessTest, EndsWithTheObject) {
  const auto start = std::chrono::steady_clock::now();
  {
    BuildProcess process({"/bin/sleep", "60"}, log_);
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

}  // namespace
}  // namespace clipgs
