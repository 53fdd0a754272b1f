#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>
#include <vector>
#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

namespace clipgs {

/// A folder of the running test, empty at its start and removed at its end.
class TestFolder {
 public:
  TestFolder() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() /
            (std::string("clipgs-") + info->test_suite_name() + "-" + info->name() + "-" +
             std::to_string(getpid()));
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TestFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Where the real volumes lie: CLIPGS_DATA, or shared/data beside the sources; may not exist.
inline std::filesystem::path data_folder() {
  const char* folder = std::getenv("CLIPGS_DATA");
  return folder != nullptr ? std::filesystem::path(folder)
                           : std::filesystem::path(CLIPGS_SOURCE_DIR) / ".." / "shared" / "data";
}

/// ITK's readers leak when they give up on a corrupt file: what is allocated while one of these
/// lives is no leak of ours.
#ifdef __SANITIZE_ADDRESS__
using LibraryLeaksIgnored = __lsan::ScopedDisabler;
#else
struct LibraryLeaksIgnored {
  LibraryLeaksIgnored() {}  // not trivial: its objects are meant to be unused
};
#endif

/// Without the fsync of write_file, for tests that write hundreds of files.
inline void write_plainly(const std::filesystem::path& path,
                          const std::vector<std::uint8_t>& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

/// The one-line message of the Error that `action` throws; "" if it throws none.
template <typename Action>
std::string error_of(const Action& action) {
  try {
    action();
  } catch (const std::exception& e) {
    return e.what();
  }
  return "";
}

}  // namespace clipgs
