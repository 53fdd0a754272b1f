#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "core/error.h"
#include "core/lock.h"
#include "serve/access_tokens.h"
#include "serve/token.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

struct TokenArguments {
  fs::path file;
  std::string add;
  std::vector<std::string> folders;
  bool writes = false;
  bool metrics = false;
  std::string expires;
  std::string remove;
};

std::vector<AccessToken>::const_iterator find_token(const std::vector<AccessToken>& tokens,
                                                    const std::string& name) {
  return std::ranges::find_if(tokens, [&](const auto& one) { return one.grant.name == name; });
}

Grant grant_of(const TokenArguments& arguments) {
  if (!is_token_name(arguments.add)) {
    throw Error("--add {}: give a name of 1 to 64 letters, digits, dots and strokes",
                arguments.add);
  }
  if (arguments.folders.empty() && !arguments.metrics) {
    throw Error("--add {}: say of which folder with --folder, or --folder . of all", arguments.add);
  }
  Grant grant{arguments.add, {}, arguments.writes, arguments.metrics};
  for (const std::string& folder : arguments.folders) {
    const auto plain = grant_folder(folder);
    if (!plain) {
      throw Error("--folder {}: is no folder below the served one; give one as cardiology/2027",
                  folder);
    }
    grant.folders.push_back(*plain);
  }
  return grant;
}

void add_token(const TokenArguments& arguments, std::vector<AccessToken> tokens) {
  if (find_token(tokens, arguments.add) != tokens.end()) {
    throw Error("{}: there is a token {} already; --remove it first, or choose another name",
                arguments.file.string(), arguments.add);
  }
  if (!arguments.expires.empty() && !is_day(arguments.expires)) {
    throw Error("--expires {}: is no day; give one as 2027-01-31", arguments.expires);
  }
  const std::string token = make_token();
  tokens.push_back({grant_of(arguments), token_digest(token), arguments.expires});
  write_tokens(arguments.file, tokens);
  fmt::print("{}\n", token);
  std::fflush(stdout);
  fmt::print(stderr,
             "It is shown this once: {} holds its digest alone. Whoever opens the server's address "
             "with it behind the last / is let in.\n",
             arguments.file.string());
}

void remove_token(const TokenArguments& arguments, std::vector<AccessToken> tokens) {
  const auto known = find_token(tokens, arguments.remove);
  if (known == tokens.cend()) {
    throw Error("{}: there is no token {}", arguments.file.string(), arguments.remove);
  }
  tokens.erase(known);
  write_tokens(arguments.file, tokens);
}

void list_tokens(const std::vector<AccessToken>& tokens) {
  for (const AccessToken& one : tokens) {
    fmt::print("{}: {}{}{}{}\n", one.grant.name,
               one.grant.folders.empty() ? "no case"
               : one.grant.sees_all()    ? "all cases"
                                         : fmt::format("{}", fmt::join(one.grant.folders, ", ")),
               one.grant.writes ? ", may write" : "", one.grant.metrics ? ", metrics" : "",
               one.expires.empty() ? ""
               : one.is_over()     ? ", over since " + one.expires
                                   : ", until " + one.expires);
  }
}

void run_token(const TokenArguments& arguments) {
  if (arguments.add.empty() && arguments.remove.empty()) {
    list_tokens(read_tokens(arguments.file));
    return;
  }
  const FileLock lock(arguments.file.string() + ".lock", arguments.file, "try again");
  const bool is_new = !fs::exists(arguments.file) && !arguments.add.empty();
  std::vector<AccessToken> tokens =
      is_new ? std::vector<AccessToken>() : read_tokens(arguments.file);
  if (arguments.add.empty()) {
    remove_token(arguments, std::move(tokens));
  } else {
    add_token(arguments, std::move(tokens));
  }
}

}  // namespace

void add_token_command(CLI::App& app) {
  auto arguments = std::make_shared<TokenArguments>();
  CLI::App* command = app.add_subcommand(
      "token", "Who may see what clipgs serve --tokens FILE serves: add, remove and list tokens");
  command->footer(
      "Example: clipgs token tokens.json --add ward-3 --folder cardiology --expires 2027-01-31\n"
      "         clipgs token tokens.json --add teacher --folder . --write\n"
      "         clipgs token tokens.json --add prometheus --metrics\n"
      "         clipgs token tokens.json --remove ward-3\n"
      "         clipgs token tokens.json");
  command->add_option("FILE", arguments->file, "File of the tokens; made with the first one")
      ->required();
  CLI::Option* add = command->add_option("--add", arguments->add,
                                         "Add a token of that name, and print it, this once");
  command
      ->add_option("--folder", arguments->folders,
                   "It sees the cases in that folder below the served one; '.': all. Repeatable")
      ->allow_extra_args(false)
      ->needs(add);
  command
      ->add_flag("--write", arguments->writes,
                 "It may change what the server keeps: marks, tours, records of a study")
      ->needs(add);
  command->add_flag("--metrics", arguments->metrics, "It may read /metrics")->needs(add);
  command
      ->add_option("--expires", arguments->expires,
                   "The last day on which it is good, as 2027-01-31 (UTC)")
      ->needs(add);
  command->add_option("--remove", arguments->remove, "Remove the token of that name")
      ->excludes(add);
  command->callback([arguments] { run_token(*arguments); });
}

}  // namespace clipgs
