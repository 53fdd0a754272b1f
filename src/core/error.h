#pragma once

#include <fmt/format.h>
#include <stdexcept>
#include <string>
#include <utility>

namespace clipgs {

/// The one exception of the project: a single line for a person, saying what failed, where, and
/// what to do about it. The command line prints it after "clipgs: " and exits with status 1.
class Error : public std::runtime_error {
 public:
  template <typename... Args>
  explicit Error(fmt::format_string<Args...> format, Args&&... args)
      : std::runtime_error(fmt::format(format, std::forward<Args>(args)...)) {}
};

/// Prints "warning: ..." as one line on standard error; work goes on.
void warn(const std::string& message);

}  // namespace clipgs
