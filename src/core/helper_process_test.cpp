#include "core/helper_process.h"

#include <cstdlib>
#include <gtest/gtest.h>
#include <string>
#include <thread>
#include <vector>

#include "core/error.h"

namespace clipgs {
namespace {

using std::chrono::milliseconds;

constexpr std::uint64_t kMemory = std::uint64_t{1} << 28;
constexpr std::uint64_t kMost = 1 << 24;
constexpr milliseconds kLong{60'000};

/// Obeys.
std::optional<std::string> work(std::string request) {
  if (request == "crash") {
    std::abort();
  }
  if (request == "hang") {
    for (;;) {
      std::this_thread::sleep_for(milliseconds(50));
    }
  }
  if (request == "devour") {
    return std::string(4 * kMemory, 'x');
  }
  if (request == "refuse") {
    return std::nullopt;
  }
  return request + request;
}

TEST(HelperProcess, AnswersUntilItIsEnded) {
  HelperProcess helper(work, kMemory);
  const std::string large(3'000'000, 'a');
  EXPECT_EQ(helper.ask("ab", kMost, kLong), "abab");
  EXPECT_EQ(helper.ask("", kMost, kLong), "");
  EXPECT_EQ(helper.ask("refuse", kMost, kLong), std::nullopt);
  EXPECT_EQ(helper.ask(large, kMost, kLong), large + large);
  EXPECT_EQ(helper.ask("too long", 15, kLong), std::nullopt);
  EXPECT_EQ(helper.ask("ab", kMost, kLong), std::nullopt);
}

TEST(HelperProcess, ACrashIsAMissingAnswer) {
  HelperProcess helper(work, kMemory);
  EXPECT_EQ(helper.ask("crash", kMost, kLong), std::nullopt);
  EXPECT_EQ(helper.ask("ab", kMost, kLong), std::nullopt);
}

TEST(HelperProcess, WhatHangsIsEnded) {
  HelperProcess helper(work, kMemory);
  EXPECT_EQ(helper.ask("hang", kMost, milliseconds(200)), std::nullopt);
}

TEST(HelperProcess, WhatWantsTooMuchMemoryIsEnded) {
  if (HelperProcess::kMemoryIsFree) {
    GTEST_SKIP() << "the address sanitizer lets nobody limit memory";
  }
  HelperProcess helper(work, kMemory);
  EXPECT_EQ(helper.ask("devour", 8 * kMemory, kLong).has_value(), false);
}

}  // namespace
}  // namespace clipgs
