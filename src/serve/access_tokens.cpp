#include "serve/access_tokens.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>
#include <sys/stat.h>
#include <unistd.h>

#include "core/error.h"
#include "core/file.h"
#include "core/json_reader.h"
#include "serve/open_file.h"
#include "serve/token.h"

namespace clipgs {

namespace fs = std::filesystem;

namespace {

constexpr int kVersion = 1;
constexpr size_t kMostTokens = 10'000;
constexpr size_t kMostFolders = 100;
constexpr size_t kMostName = 64;
constexpr std::uintmax_t kMostTokenBytes = std::uintmax_t{16} << 20;
constexpr size_t kDigestDigits = 64;
constexpr const char* kRemedy = "make it with clipgs token";

/// systemd gives a service its own copies of secrets there, which it guards by other means than
/// their mode.
bool is_credential(const fs::path& file) {
  const char* const folder = std::getenv("CREDENTIALS_DIRECTORY");
  return folder != nullptr && fs::absolute(file).parent_path() == fs::path(folder);
}

void require_private(const fs::path& file) {
  struct stat status{};
  if (::stat(file.c_str(), &status) != 0) {
    throw Error("{}: there is no such file of tokens; make one with clipgs token {} --add NAME",
                file.string(), file.string());
  }
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0 && !is_credential(file)) {
    throw Error("{}: others than its owner may open it (mode {:04o}); run chmod 600 {}",
                file.string(), status.st_mode & 07777, file.string());
  }
}

std::optional<std::chrono::sys_days> day_of(const std::string& text) {
  constexpr size_t kLength = 10;
  const auto number = [&](size_t begin, size_t size) {
    int value = -1;
    const char* const end = text.data() + begin + size;
    const auto [rest, error] = std::from_chars(text.data() + begin, end, value);
    return error == std::errc() && rest == end ? value : -1;
  };
  if (text.size() != kLength || text[4] != '-' || text[7] != '-') {
    return std::nullopt;
  }
  const std::chrono::year_month_day day{std::chrono::year(number(0, 4)),
                                        std::chrono::month(static_cast<unsigned>(number(5, 2))),
                                        std::chrono::day(static_cast<unsigned>(number(8, 2)))};
  return day.ok() ? std::optional(std::chrono::sys_days(day)) : std::nullopt;
}

std::vector<std::string> folders_of(const nlohmann::json& object, const JsonReader& reader) {
  std::vector<std::string> folders;
  const nlohmann::json list = object.value("folders", nlohmann::json());
  if (!list.is_array() || list.size() > kMostFolders) {
    reader.fail("folders", "a list of folders, [\".\"] for all");
  }
  for (const nlohmann::json& one : list) {
    const auto folder = one.is_string() ? grant_folder(one.get<std::string>()) : std::nullopt;
    if (!folder) {
      reader.fail("folders", "a list of folders below the served one, [\".\"] for all");
    }
    folders.push_back(*folder);
  }
  return folders;
}

AccessToken token_of(const nlohmann::json& object, const std::string& where) {
  const JsonReader reader(object, where, kRemedy);
  // "expire" would last for ever.
  reader.allow_only({"name", "sha256", "folders", "writes", "metrics", "expires"});
  AccessToken token;
  token.grant.name = reader.text("name");
  token.sha256 = reader.text("sha256");
  token.grant.folders = folders_of(object, reader);
  token.grant.writes = reader.has("writes") && reader.boolean("writes");
  token.grant.metrics = reader.has("metrics") && reader.boolean("metrics");
  token.expires = reader.has("expires") ? reader.text("expires") : "";
  if (!is_token_name(token.grant.name)) {
    reader.fail("name", "1 to 64 letters, digits, dots, strokes");
  }
  if (token.sha256.size() != kDigestDigits ||
      token.sha256.find_first_not_of("0123456789abcdef") != std::string::npos) {
    reader.fail("sha256", "64 hexadecimal digits");
  }
  if (!token.expires.empty() && !is_day(token.expires)) {
    reader.fail("expires", "a day as 2027-01-31");
  }
  return token;
}

}  // namespace

bool Grant::sees_all() const { return std::ranges::find(folders, ".") != folders.end(); }

bool Grant::may_see(std::string_view case_name) const {
  return std::ranges::any_of(folders, [&](const std::string& folder) {
    return folder == "." ||
           (case_name.starts_with(folder) && case_name.substr(folder.size()).starts_with('/'));
  });
}

bool AccessToken::is_over() const {
  const auto last = day_of(expires);
  // In days: far ones are out of the reach of the clock's nanoseconds.
  return last && std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now()) > *last;
}

bool is_token_name(std::string_view name) {
  return !name.empty() && name.size() <= kMostName && std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
           c == '_' || c == '-';
  });
}

bool is_day(const std::string& text) { return day_of(text).has_value(); }

std::optional<std::string> grant_folder(const std::string& folder) {
  std::string plain = fs::path(folder).lexically_normal().generic_string();
  if (plain.size() > 1 && plain.ends_with('/')) {
    plain.pop_back();
  }
  if (plain == ".") {
    return plain;
  }
  const bool hidden = plain.starts_with('.') || plain.find("/.") != std::string::npos;
  return plain.empty() || plain.starts_with('/') || hidden ? std::nullopt : std::optional(plain);
}

std::vector<AccessToken> read_tokens(const fs::path& file) {
  require_private(file);
  const std::vector<std::uint8_t> bytes = read_file(file, kMostTokenBytes);
  const nlohmann::json json = nlohmann::json::parse(bytes, nullptr, false);
  if (!json.is_object() || json.value("clipgs_tokens", nlohmann::json()) != kVersion ||
      !json.contains("tokens") || !json["tokens"].is_array()) {
    throw Error("{}: is no file of tokens of version 1; {}", file.string(), kRemedy);
  }
  if (json["tokens"].size() > kMostTokens) {
    throw Error("{}: holds more than {} tokens; remove some", file.string(), kMostTokens);
  }
  std::vector<AccessToken> tokens;
  std::set<std::string> names;
  for (const nlohmann::json& one : json["tokens"]) {
    const std::string where = fmt::format("{}: tokens[{}]", file.string(), tokens.size());
    if (!one.is_object()) {
      throw Error("{}: is no token; {}", where, kRemedy);
    }
    tokens.push_back(token_of(one, where));
    if (!names.insert(tokens.back().grant.name).second) {
      throw Error("{}: a second token is called {}; give it another name", where,
                  tokens.back().grant.name);
    }
  }
  return tokens;
}

void write_tokens(const fs::path& file, const std::vector<AccessToken>& tokens) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const AccessToken& token : tokens) {
    nlohmann::ordered_json one = {{"name", token.grant.name},
                                  {"sha256", token.sha256},
                                  {"folders", token.grant.folders},
                                  {"writes", token.grant.writes}};
    if (token.grant.metrics) {
      one["metrics"] = true;
    }
    if (!token.expires.empty()) {
      one["expires"] = token.expires;
    }
    list.push_back(std::move(one));
  }
  const nlohmann::ordered_json json = {{"clipgs_tokens", kVersion}, {"tokens", std::move(list)}};
  struct stat before{};
  const bool was_there = ::stat(file.c_str(), &before) == 0;
  const mode_t mask = ::umask(0077);
  try {
    write_text(file, json.dump(2) + "\n");
  } catch (...) {
    ::umask(mask);
    throw;
  }
  ::umask(mask);
  if (was_there && ::chown(file.c_str(), before.st_uid, before.st_gid) != 0) {
    warn(fmt::format("{}: belongs to another user now; let the one whom the server runs as own it",
                     file.string()));
  }
}

TokenBook::TokenBook(const fs::path& file) : file_(fs::absolute(file)) {
  tokens_ = std::make_shared<const std::vector<AccessToken>>(read_tokens(file_));
  version_ = file_state(file_).value_or(FileState()).version;
}

std::optional<AccessToken> TokenBook::find(std::string_view text) {
  const Tokens known = tokens();
  if (!known) {
    throw Error(
        "the tokens of this server cannot be read; tell who runs it to look at what it says");
  }
  // All of them, so that the time tells nothing of where it stands.
  const std::string digest = token_digest(text);
  std::optional<AccessToken> found;
  for (const AccessToken& one : *known) {
    if (is_same_secret(digest, one.sha256)) {
      found = one;
    }
  }
  return found;
}

TokenBook::Tokens TokenBook::tokens() {
  const std::string version = file_state(file_).value_or(FileState()).version;
  const std::scoped_lock lock(mutex_);
  if (version != version_) {
    version_ = version;
    try {
      tokens_ = std::make_shared<const std::vector<AccessToken>>(read_tokens(file_));
    } catch (const Error& error) {
      warn(std::string(error.what()) + "; until then nobody is let in");
      tokens_ = nullptr;
    }
  }
  return tokens_;
}

}  // namespace clipgs
