#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>
#include <vector>

#include "cli/process.h"
#include "core/file.h"

namespace clipgs::testing_support {

/// A folder of a test's own, and what it tries the program with.
class CliTest : public ::testing::Test {
 protected:
  CliTest()
      : folder_(std::filesystem::path(::testing::TempDir()) /
                ("clipgs-cli-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
    ::setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
  }
  ~CliTest() override { std::filesystem::remove_all(folder_); }

  std::string at(const std::string& name) const { return (folder_ / name).string(); }

  std::string phantom() const {
    const std::string path = at("phantom.nrrd");
    if (!std::filesystem::exists(path)) {
      EXPECT_EQ(run_clipgs({"phantom", path, "--size", "40"}).status, 0);
    }
    return path;
  }

  /// A build small enough for a test, but with every step of a real one.
  std::vector<std::string> small_build(const std::string& output) const {
    return {
        "build",    phantom(),        "-o",     at(output),      "--quality", "draft",   "--size",
        "48",       "--train-frames", "8",      "--test-frames", "1",         "--steps", "120",
        "--budget", "1500",           "--quiet"};
  }

  /// Two voxels of a metre a side, so that the patient's left is label 1 if `x` is −500.
  std::string write_labels(const std::string& name, int x) const {
    const std::string header =
        "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nspace: right-anterior-superior\n"
        "space directions: (1000,0,0) (0,1000,0) (0,0,1000)\nencoding: raw\nspace origin: (" +
        std::to_string(x) + ",-500,-500)\n\n";
    write_text(at(name), header + std::string("\1\0\1\0\1\0\1\0", 8));
    return at(name);
  }

  /// Fails in one line on standard error, with exit status 1, and leaves no file at `output`.
  void expect_failure(const std::vector<std::string>& arguments, const std::string& says,
                      const std::string& output = "") {
    const Finished finished = run_clipgs(arguments);
    EXPECT_EQ(finished.status, 1) << finished.err;
    const size_t start = finished.err.find("clipgs: ");
    ASSERT_NE(start, std::string::npos) << finished.err;
    const std::string line = finished.err.substr(start);
    EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1) << finished.err;
    EXPECT_THAT(line, ::testing::HasSubstr(says));
    if (!output.empty()) {
      EXPECT_FALSE(std::filesystem::exists(output));
    }
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_)) {
      EXPECT_THAT(entry.path().string(), ::testing::Not(::testing::HasSubstr(".part")))
          << "left behind";
    }
  }

  std::filesystem::path folder_;
};

}  // namespace clipgs::testing_support
