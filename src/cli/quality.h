#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace clipgs {

/// How much work a build puts in, or a step of it.
struct Quality {
  const char* name;
  int size;  // px, training and test pictures
  int train_frames;
  int test_frames;  // per test split; half as many per validation split
  int train_spp;
  size_t budget;
  size_t steps;
  int sh_degree;
};

/// Throws CLI::ValidationError for a quality that there is not.
const Quality& find_quality(const std::string& name);

/// Adds --quality to a command that does one step of a build: `take` is given the numbers, which
/// are what the options that are added later say unless they are given themselves.
void add_step_quality(CLI::App& command, const std::string& what,
                      std::function<void(const Quality&)> take);

}  // namespace clipgs
