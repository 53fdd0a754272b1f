#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace clipgs {

/// An option or argument of a command, as the parser has it.
struct DescribedOption {
  std::vector<std::string> names;    ///< "-o", "--output"; of an argument without dashes its name
  std::string value;                 ///< what it takes, "INT"; "": nothing, it is a flag
  std::string limits;                ///< of that, "8 - 1024" or ".sog"; "": none, or `choices`
  std::vector<std::string> choices;  ///< empty: it is free
  std::string usual;                 ///< what it is if it is not given; "": the text says it
  std::string text;
  std::string group;  ///< the heading that the help has it under
  bool is_argument = false;
  bool is_required = false;
};

/// A command of the program: of the program itself, what all of them take.
struct DescribedCommand {
  std::string name;
  std::string text;                   ///< in a line
  std::string notes;                  ///< below the options, without examples
  std::vector<std::string> examples;  ///< command lines
  std::vector<DescribedOption> options;
};

/// What `command` offers.
DescribedCommand describe(const CLI::App& command);

/// What the commands of the program offer, by their names.
std::vector<DescribedCommand> describe_commands(const CLI::App& program);

}  // namespace clipgs
