#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace clipgs {

/// What somebody may do here.
struct Grant {
  std::string name;                  ///< of the token; "": there are no named ones
  std::vector<std::string> folders;  ///< below the served one, "a/b"; ".": the served one itself
  bool writes = false;               ///< marks, tours, records of a study; where these are kept
  bool metrics = false;              ///< /metrics may be read

  /// Whether the cases of all folders may be seen.
  bool sees_all() const;
  /// Whether a case may be: one in one of the folders, or deeper.
  bool may_see(std::string_view case_name) const;
};

/// A token of which only the digest is kept.
struct AccessToken {
  Grant grant;
  std::string sha256;   ///< token_digest()
  std::string expires;  ///< the last day on which it is good, "2027-01-31" (UTC); "": none

  bool is_over() const;
};

/// What a token is called: 1 to 64 of a-z, A-Z, 0-9, ".", "_" and "-".
bool is_token_name(std::string_view name);
/// "2027-01-31", of a day that there is.
bool is_day(const std::string& text);
/// A folder as it is written in grants, or nothing where it leaves the served one, or is hidden.
std::optional<std::string> grant_folder(const std::string& folder);

/// The tokens of a file (docs/service.md), which nobody but its owner may read. Throws Error.
std::vector<AccessToken> read_tokens(const std::filesystem::path& file);
/// Readable by the owner alone: whoever owned it before, where there was one.
void write_tokens(const std::filesystem::path& file, const std::vector<AccessToken>& tokens);

/// The tokens of a file as it is now: what changes there is seen at the next request. Safe to use
/// from several threads.
class TokenBook {
 public:
  /// Throws Error if the file cannot be read.
  explicit TokenBook(const std::filesystem::path& file);

  /// The token of that text, as people may type it. Throws Error, without the file's name, while
  /// the file cannot be read: nobody is let in by what it once said.
  std::optional<AccessToken> find(std::string_view text);

 private:
  using Tokens = std::shared_ptr<const std::vector<AccessToken>>;

  Tokens tokens();

  std::filesystem::path file_;
  std::mutex mutex_;
  std::string version_;
  Tokens tokens_;  ///< null: what is there cannot be read
};

}  // namespace clipgs
