#include "core/memory.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <limits>
#include <unistd.h>

#include "core/file.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;

class MemoryTest : public testing::Test {
 protected:
  MemoryTest() : root_(fs::path(testing::TempDir()) / fmt::format("clipgs-memory-{}", getpid())) {}
  ~MemoryTest() override { fs::remove_all(root_); }
  void write(const fs::path& file, const std::string& text) {
    fs::create_directories((root_ / file).parent_path());
    write_text(root_ / file, text);
  }
  fs::path root_;
};

TEST_F(MemoryTest, IsWhatTheKernelCallsAvailable) {
  write("proc/meminfo", "MemTotal:  9000 kB\nMemFree: 100 kB\nMemAvailable:   5120 kB\n");
  EXPECT_EQ(available_memory(root_), 5 * kMiB);
  write("proc/meminfo", "MemAvailable: 5120 kB\nSwapTotal: 9216 kB\nSwapFree: 1024 kB\n");
  EXPECT_EQ(available_memory(root_), 6 * kMiB);
}

TEST_F(MemoryTest, IsUnknownWhereNothingSaysIt) {
  EXPECT_EQ(available_memory(root_), std::numeric_limits<std::uint64_t>::max());
}

TEST_F(MemoryTest, IsLimitedByEveryGroupAboveTheProcess) {
  write("proc/meminfo", "MemAvailable: 8388608 kB\n");
  write("proc/self/cgroup", "0::/user/one\n");
  write("sys/fs/cgroup/user/one/memory.max", "max\n");
  write("sys/fs/cgroup/user/one/memory.current", "1048576\n");
  EXPECT_EQ(available_memory(root_), 8192 * kMiB);
  // The group above leaves 64 MiB; 16 of the 48 that it uses are caches.
  write("sys/fs/cgroup/user/memory.max", std::to_string(96 * kMiB));
  write("sys/fs/cgroup/user/memory.current", std::to_string(48 * kMiB));
  write("sys/fs/cgroup/user/memory.stat",
        fmt::format("anon 7\ninactive_file {}\nactive_file {}\n", 12 * kMiB, 4 * kMiB));
  EXPECT_EQ(available_memory(root_), 64 * kMiB);
}

TEST_F(MemoryTest, IsLimitedByGroupsOfTheFirstVersion) {
  write("proc/meminfo", "MemAvailable: 8388608 kB\n");
  write("proc/self/cgroup", "4:cpu,memory:/a\n2:pids:/b\n0::/\n");
  write("sys/fs/cgroup/memory/a/memory.limit_in_bytes", std::to_string(10 * kMiB));
  write("sys/fs/cgroup/memory/a/memory.usage_in_bytes", std::to_string(40 * kMiB));
  EXPECT_EQ(available_memory(root_), 0U);
}

TEST_F(MemoryTest, OfThisMachineIsKnown) {
  EXPECT_GT(available_memory(), kMiB);
  EXPECT_LT(available_memory(), std::uint64_t{1} << 50);
}

TEST_F(MemoryTest, IsSaidInGigabytes) { EXPECT_EQ(gigabytes(5149000000), "5.1 GB"); }

}  // namespace
}  // namespace clipgs
