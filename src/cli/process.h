#pragma once

#include <string>
#include <vector>

namespace clipgs::testing_support {

/// What a finished run of the program left.
struct Finished {
  int status = -1;  ///< exit status, or 128 + signal
  std::string out;
  std::string err;
};

/// Runs the built clipgs with these arguments, to its end.
Finished run_clipgs(const std::vector<std::string>& arguments);

/// Starts it, and kills it with SIGKILL after `seconds` unless it has ended by then. Returns
/// whether it had to be killed.
bool run_clipgs_and_kill(const std::vector<std::string>& arguments, double seconds);

}  // namespace clipgs::testing_support
