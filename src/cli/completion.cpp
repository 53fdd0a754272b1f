#include "cli/completion.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/shell_word.h"

namespace clipgs {

namespace {

/// Text with a backslash before every letter of `special`.
std::string escaped(const std::string& text, std::string_view special) {
  std::string safe;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) {
      safe += '\\';
    }
    safe += c;
  }
  return safe;
}

/// As much of what an option is as a line of a list has room for.
std::string in_short(const std::string& text) {
  constexpr size_t kLongest = 90;
  const std::string first = text.substr(0, std::min(text.find("; "), text.find(". ")));
  return first.size() <= kLongest ? first : first.substr(0, first.rfind(' ', kLongest)) + " ...";
}

std::string names_of(const DescribedCommand& command) {
  std::string names;
  for (const DescribedOption& option : command.options) {
    if (!option.is_argument) {
      names += fmt::format("{}{}", names.empty() ? "" : " ", fmt::join(option.names, " "));
    }
  }
  return names;
}

std::string names_of(std::span<const DescribedCommand> commands) {
  std::string names;
  for (const DescribedCommand& command : commands) {
    names += (names.empty() ? "" : " ") + command.name;
  }
  return names;
}

/// One argument of zsh's _arguments for each name of an option.
std::string zsh_options(const DescribedCommand& command, std::string_view indent) {
  std::string lines;
  for (const DescribedOption& option : command.options) {
    if (option.is_argument) {
      continue;
    }
    const std::string text = escaped(in_short(option.text), "[]\\:");
    for (const std::string& name : option.names) {
      std::string value;
      if (!option.choices.empty()) {
        value = fmt::format(":value:({})", fmt::join(option.choices, " "));
      } else if (!option.value.empty()) {
        value = ":value:_files";
      }
      lines +=
          fmt::format("{}{} \\\n", indent, shell_word(fmt::format("{}[{}]{}", name, text, value)));
    }
  }
  return lines;
}

}  // namespace

std::string bash_completion(const DescribedCommand& program,
                            std::span<const DescribedCommand> commands) {
  std::string values;
  std::string options;
  for (const DescribedCommand& command : commands) {
    for (const DescribedOption& option : command.options) {
      if (option.choices.empty()) {
        continue;
      }
      std::string cases;
      // An argument comes behind the command itself.
      const std::vector<std::string> after =
          option.is_argument ? std::vector{command.name} : option.names;
      for (const std::string& name : after) {
        cases += fmt::format("{}\"{} {}\"", cases.empty() ? "" : " | ", command.name, name);
      }
      values += fmt::format("    {}) words={} ;;\n", cases,
                            shell_word(fmt::format("{}", fmt::join(option.choices, " "))));
    }
    options += fmt::format("      {}) words={} ;;\n", command.name,
                           shell_word(names_of(command) + " " + names_of(program)));
  }
  const std::string names = names_of(commands);
  return fmt::format(
      R"(# Completes clipgs in bash: source it, or put it into bash-completion's folder as "clipgs".
_clipgs() {{
  local current="${{COMP_WORDS[COMP_CWORD]}}" previous="${{COMP_WORDS[COMP_CWORD - 1]}}" command="" words="" i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case " {0} " in
      *" ${{COMP_WORDS[i]}} "*) command="${{COMP_WORDS[i]}}"; break ;;
    esac
  done
  case "$command $previous" in
{1}  esac
  if [ -z "$words" ] && [[ $current == -* ]]; then
    case "$command" in
{2}      *) words={3} ;;
    esac
  elif [ -z "$words" ] && [ -z "$command" ]; then
    words={4}
  fi
  COMPREPLY=()
  if [ -n "$words" ]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  fi
}}
complete -o default -F _clipgs clipgs
)",
      names, values, options, shell_word(names_of(program)), shell_word(names));
}

std::string zsh_completion(const DescribedCommand& program,
                           std::span<const DescribedCommand> commands) {
  std::string names;
  std::string cases;
  for (const DescribedCommand& command : commands) {
    names += "    " + shell_word(command.name + ":" + escaped(command.text, "\\:")) + "\n";
    cases += fmt::format("        {})\n          _arguments \\\n{}            '*:file:_files' ;;\n",
                         command.name, zsh_options(command, "            "));
  }
  return fmt::format(R"(#compdef clipgs
# Completes clipgs in zsh: put it into a folder of $fpath as "_clipgs".
_clipgs() {{
  local context state line
  typeset -A opt_args
  local -a commands=(
{}  )
  _arguments -C \
{}    '1:command:->command' '*::argument:->arguments'
  case $state in
    command) _describe command commands ;;
    arguments)
      case $line[1] in
{}      esac ;;
  esac
}}
_clipgs "$@"
)",
                     names, zsh_options(program, "    "), cases);
}

std::string fish_completion(const DescribedCommand& program,
                            std::span<const DescribedCommand> commands) {
  std::string lines =
      "# Completes clipgs in fish: put it into ~/.config/fish/completions as \"clipgs.fish\".\n";
  const auto add = [&](const DescribedOption& option, const std::string& when) {
    if (option.is_argument) {
      return;
    }
    lines += "complete -c clipgs" + when;
    for (const std::string& name : option.names) {
      lines += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    }
    if (!option.choices.empty()) {
      lines += fmt::format(" -x -a '{}'", fmt::join(option.choices, " "));
    } else if (!option.value.empty()) {
      lines += " -r";
    }
    lines += fmt::format(" -d '{}'\n", escaped(in_short(option.text), "\\'"));
  };
  for (const DescribedOption& option : program.options) {
    add(option, "");
  }
  for (const DescribedCommand& command : commands) {
    lines += fmt::format("complete -c clipgs -n __fish_use_subcommand -f -a {} -d '{}'\n",
                         command.name, escaped(command.text, "\\'"));
    for (const DescribedOption& option : command.options) {
      add(option, " -n '__fish_seen_subcommand_from " + command.name + "'");
    }
  }
  return lines;
}

}  // namespace clipgs
