#include "cli/man_page.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/version.h"

namespace clipgs {

namespace {

/// Text that no letter of is a request of roff's.
std::string plain(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    const bool is_first = safe.empty() || safe.back() == '\n';
    if (is_first && (c == '.' || c == '\'')) {
      safe += "\\&";
    }
    safe += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
  }
  return safe;
}

std::string bold(const std::string& text) { return "\\fB" + plain(text) + "\\fR"; }
std::string slanted(const std::string& text) { return "\\fI" + plain(text) + "\\fR"; }

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  return text;
}

std::string head(const std::string& name, const std::string& text) {
  const std::string version = program_version();
  return fmt::format(".TH \"{}\" 1 \"\" \"clipgs {}\" \"clipgs\"\n.SH NAME\n{} \\- {}\n",
                     plain(upper(name)), plain(version), plain(name), plain(text));
}

/// "8 - 1024" or "srgb, filmic", and what is usual.
std::string limits_of(const DescribedOption& option) {
  std::vector<std::string> said;
  if (!option.choices.empty()) {
    said.push_back(fmt::format("{}", fmt::join(option.choices, ", ")));
  } else if (!option.limits.empty() && option.text.find(option.limits) == std::string::npos) {
    said.push_back(option.limits);
  }
  if (!option.usual.empty()) {
    said.push_back("default: " + option.usual);
  }
  if (option.is_required && !option.is_argument) {
    said.emplace_back("required");
  }
  return said.empty() ? "" : fmt::format(" [{}]", fmt::join(said, "; "));
}

std::string option_entry(const DescribedOption& option) {
  std::vector<std::string> names;
  names.reserve(option.names.size());
  for (const std::string& name : option.names) {
    names.push_back(option.is_argument ? slanted(name) : bold(name));
  }
  const std::string value =
      option.is_argument || option.value.empty() ? "" : " " + slanted(option.value);
  return fmt::format(".TP\n{}{}\n{}\n", fmt::join(names, ", "), value,
                     plain(option.text + limits_of(option)));
}

std::string entries(const DescribedCommand& command) {
  std::string page;
  std::string group;
  for (const bool arguments : {true, false}) {
    for (const DescribedOption& option : command.options) {
      if (option.is_argument != arguments) {
        continue;
      }
      const std::string heading = arguments ? "ARGUMENTS" : upper(option.group);
      if (heading != group) {
        page += fmt::format(".SH \"{}\"\n", plain(heading));
        group = heading;
      }
      page += option_entry(option);
    }
  }
  return page;
}

std::string tail(const std::vector<std::string>& examples, const std::string& see) {
  std::string page;
  if (!examples.empty()) {
    page += ".SH EXAMPLES\n.nf\n";
    for (const std::string& line : examples) {
      page += plain(line) + "\n";
    }
    page += ".fi\n";
  }
  return page +
         ".SH \"EXIT STATUS\"\n0: done. 1: failed, as one line on standard error says. 2: wrong "
         "usage.\n"
         ".SH \"SEE ALSO\"\n" +
         see + "\n";
}

}  // namespace

std::string program_page(const DescribedCommand& program,
                         std::span<const DescribedCommand> commands) {
  std::string page = head(program.name, program.text.substr(program.text.find(": ") + 2));
  page += fmt::format(".SH SYNOPSIS\n{} [options] {} [options]\n", bold(program.name),
                      slanted("command"));
  page += ".SH DESCRIPTION\nA research tool; not for diagnosis.\n.SH COMMANDS\n";
  std::vector<std::string> pages;
  for (const DescribedCommand& command : commands) {
    page += fmt::format(".TP\n{}\n{}\n", bold(command.name), plain(command.text));
    pages.push_back(bold(program.name + "-" + command.name) + "(1)");
  }
  return page + entries(program) + tail({}, fmt::format("{}", fmt::join(pages, ", ")));
}

std::string command_page(const DescribedCommand& program, const DescribedCommand& command) {
  const std::string name = program.name + "-" + command.name;
  std::string page = head(name, command.text) + ".SH SYNOPSIS\n" +
                     bold(program.name + " " + command.name) + " [options]";
  for (const DescribedOption& option : command.options) {
    if (option.is_argument) {
      page += " " + slanted(option.names.front());
    }
  }
  page += "\n";
  if (!command.notes.empty()) {
    page += ".SH DESCRIPTION\n" + plain(command.notes) + "\n";
  }
  return page + entries(command) + tail(command.examples, bold(program.name) + "(1)");
}

}  // namespace clipgs
