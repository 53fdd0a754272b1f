#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace clipgs {

/// A program that runs beside this one, and that ends with it, however this one ends.
class BuildProcess {
 public:
  /// `words`: the program and its arguments. What it says goes into the file `log`, from its start.
  /// Throws Error.
  BuildProcess(std::vector<std::string> words, const std::filesystem::path& log);
  /// Ends what still runs.
  ~BuildProcess();
  BuildProcess(const BuildProcess&) = delete;
  BuildProcess& operator=(const BuildProcess&) = delete;

  /// Its exit status, or 128 + signal; nothing while it runs.
  std::optional<int> status();

 private:
  pid_t pid_ = -1;
  std::optional<int> status_;
};

}  // namespace clipgs
