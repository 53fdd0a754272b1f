#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "archive/http_client.h"

namespace clipgs {

/// How a hospital's archive is told who asks; files, as command lines are seen by others.
struct ArchiveArguments {
  std::string token_file;
  std::string user;
  std::string password_file;
  std::string certificate;
  std::string key;
  std::string authorities;
};

/// Adds the options, in a group of their own. `arguments` must outlive the parsing.
void add_archive_options(CLI::App& command, ArchiveArguments& arguments);

/// With the secrets of the files, or else of CLIPGS_ARCHIVE_TOKEN and CLIPGS_ARCHIVE_PASSWORD.
/// Throws Error, also for files with secrets that everybody may read.
HttpOptions http_options(const ArchiveArguments& arguments);

}  // namespace clipgs
