#include "cli/described.h"

#include <algorithm>
#include <sstream>

namespace clipgs {

namespace {

std::vector<std::string> split(const std::string& text, char by) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, by);) {
    parts.push_back(part);
  }
  return parts;
}

/// CLI11 writes what a check wants behind the type: "TEXT:{srgb,filmic}", "INT:INT in [8 - 1024]".
void take_limits(const std::string& limits, DescribedOption& described) {
  const size_t from = limits.find_first_of("{[");
  const size_t to = limits.find_last_of("}]");
  const bool is_enclosed = from != std::string::npos && to != std::string::npos && to > from;
  const std::string inner = is_enclosed ? limits.substr(from + 1, to - from - 1) : limits;
  if (is_enclosed && limits[from] == '{') {
    described.choices = split(inner, ',');
  } else {
    described.limits = inner;
  }
}

DescribedOption described_option(const CLI::Option& option) {
  DescribedOption described;
  described.is_argument = option.get_positional();
  described.names = split(option.get_name(described.is_argument, true), ',');
  if (option.get_items_expected_max() > 0) {
    const std::string type = option.get_type_name();
    const size_t colon = type.find(':');
    described.value = type.substr(0, colon);
    if (colon != std::string::npos) {
      take_limits(type.substr(colon + 1), described);
    }
  }
  described.usual = option.get_default_str();
  described.text = option.get_description();
  described.group = option.get_group();
  described.is_required = option.get_required();
  return described;
}

/// A footer's lines: what stands behind "Example:", and below it as far to the right, is examples.
void take_footer(const std::string& footer, DescribedCommand& described) {
  const std::string example = "Example: ";
  for (const std::string& line : split(footer, '\n')) {
    if (line.starts_with(example) || line.starts_with(std::string(example.size(), ' '))) {
      described.examples.push_back(line.substr(example.size()));
    } else {
      described.notes += (described.notes.empty() ? "" : " ") + line;
    }
  }
}

}  // namespace

DescribedCommand describe(const CLI::App& command) {
  DescribedCommand described{.name = command.get_name(),
                             .text = command.get_description(),
                             .notes = {},
                             .examples = {},
                             .options = {}};
  take_footer(command.get_footer(), described);
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_group().empty()) {  // as what is hidden has it
      described.options.push_back(described_option(*option));
    }
  }
  return described;
}

std::vector<DescribedCommand> describe_commands(const CLI::App& program) {
  std::vector<DescribedCommand> commands;
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; })) {
    commands.push_back(describe(*command));
  }
  std::ranges::sort(commands, {}, &DescribedCommand::name);
  return commands;
}

}  // namespace clipgs
