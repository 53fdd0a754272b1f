// What makes a libFuzzer program of a target: its seeds become a corpus beside those that the
// command line names, and an Error is a good answer.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <system_error>
#include <unistd.h>

#include "core/error.h"
#include "core/file.h"
#include "core/fuzz.h"
#include "core/progress.h"

namespace clipgs::fuzz {

namespace fs = std::filesystem;

namespace {

void write_plainly(const fs::path& path, std::span<const std::uint8_t> bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

void remove_scratch_folder() {
  std::error_code ignored;
  fs::remove_all(scratch_folder(), ignored);
}

}  // namespace

const fs::path& scratch_folder() {
  static const fs::path kFolder = [] {
    const fs::path memory = "/dev/shm";
    std::error_code ignored;
    const fs::path base = fs::is_directory(memory, ignored) ? memory : fs::temp_directory_path();
    fs::path folder = base / ("clipgs-fuzz-" + std::to_string(::getpid()));
    fs::create_directories(folder);
    return folder;
  }();
  return kFolder;
}

fs::path as_file(std::span<const std::uint8_t> input, std::string_view name) {
  fs::path path = scratch_folder() / name;
  write_plainly(path, input);
  return path;
}

Bytes bytes_of(std::string_view text) { return {text.begin(), text.end()}; }
std::string text_of(std::span<const std::uint8_t> input) { return {input.begin(), input.end()}; }

}  // namespace clipgs::fuzz

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  using namespace clipgs;
  Progress::set_enabled(false);
  std::atexit(fuzz::remove_scratch_folder);
  // libFuzzer takes folders or, to read them once again, files.
  if (std::any_of(*argv + 1, *argv + *argc,
                  [](const char* word) { return std::filesystem::is_regular_file(word); })) {
    return 0;
  }
  const std::filesystem::path folder = fuzz::scratch_folder() / "seeds";
  std::filesystem::create_directories(folder);
  int number = 0;
  for (const fuzz::Bytes& seed : fuzz::seeds()) {
    fuzz::write_plainly(folder / std::to_string(number++), seed);
  }
  static std::string corpus = folder.string();
  static std::vector<char*> arguments(*argv, *argv + *argc);
  arguments.push_back(corpus.data());
  arguments.push_back(nullptr);
  *argv = arguments.data();
  ++*argc;
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, size_t size) {
  try {
    clipgs::fuzz::read({data, size});
  } catch (const clipgs::Error&) {  // NOLINT(bugprone-empty-catch): refusing is what is wanted
  }
  return 0;
}
