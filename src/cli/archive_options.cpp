#include "cli/archive_options.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <sys/stat.h>

#include "core/error.h"
#include "core/file.h"

namespace clipgs {

namespace {

constexpr const char* kGroup = "Who asks an archive";
constexpr size_t kMostSecret = 16384;  // bytes; tokens may be long

/// The text of a file without the end of its line.
std::string secret_in(const std::string& path) {
  struct stat status{};
  if (::stat(path.c_str(), &status) == 0 && (status.st_mode & S_IRWXO) != 0) {
    throw Error("{}: everybody on this machine may read this secret; run chmod o= {}", path, path);
  }
  const std::vector<std::uint8_t> bytes = read_file(path, kMostSecret);
  std::string text(bytes.begin(), bytes.end());
  text.resize(text.find_last_not_of("\r\n") + 1);
  return text;
}

/// Of the file, if there is one, else of the variable.
std::string secret(const std::string& file, const char* variable) {
  const char* const value = std::getenv(variable);
  const std::string text = !file.empty() ? secret_in(file) : value != nullptr ? value : "";
  const auto is_control = [](unsigned char c) { return std::iscntrl(c) != 0; };
  if ((text.empty() && !file.empty()) || std::ranges::any_of(text, is_control)) {
    throw Error("{}: holds no token or password; give one, in one line",
                file.empty() ? variable : file);
  }
  return text;
}

}  // namespace

void add_archive_options(CLI::App& command, ArchiveArguments& arguments) {
  const auto add = [&](const char* name, std::string& value, const char* text) {
    return command.add_option(name, value, text)->group(kGroup);
  };
  add("--token-file", arguments.token_file,
      "File with the token (a bearer's) that the archive wants (default: CLIPGS_ARCHIVE_TOKEN of "
      "the environment)");
  CLI::Option* const user =
      add("--user", arguments.user, "Name that the archive knows (basic authentication)");
  add("--password-file", arguments.password_file,
      "File with its password (default: CLIPGS_ARCHIVE_PASSWORD of the environment)")
      ->needs(user);
  CLI::Option* const certificate = add("--client-certificate", arguments.certificate,
                                       "Your own certificate, where the archive wants one (PEM)");
  certificate->needs(add("--client-key", arguments.key, "Its key (PEM)")->needs(certificate));
  add("--ca-file", arguments.authorities,
      "Certificates of the authorities to trust instead of the system's (PEM)");
}

HttpOptions http_options(const ArchiveArguments& arguments) {
  HttpOptions options;
  options.user = arguments.user;
  if (!arguments.user.empty()) {
    options.password = secret(arguments.password_file, "CLIPGS_ARCHIVE_PASSWORD");
  } else {
    options.token = secret(arguments.token_file, "CLIPGS_ARCHIVE_TOKEN");
  }
  options.certificate = arguments.certificate;
  options.key = arguments.key;
  options.authorities = arguments.authorities;
  return options;
}

}  // namespace clipgs
