#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "serve/access_tokens.h"
#include "serve/answer.h"
#include "serve/client.h"
#include "serve/throttle.h"

namespace clipgs {

/// Who is let in: everyone, those who know the one token, or those who know one of a file's. A
/// token is brought in the address, once, and kept in a cookie from then on, or by programs as
/// "Authorization: Bearer TOKEN". Safe to use from several threads.
class Entrance {
 public:
  /// `token`: "" where there is none; `tokens`: the file of named ones, "" without it. Throws
  /// Error.
  Entrance(std::string token, const std::filesystem::path& tokens);

  /// What the client may do here. Nothing where it is refused, or sent on without the token in the
  /// address; then `answer` is that. Throws Error while the tokens cannot be read.
  std::optional<Grant> admit(const HttpRequest& request, const std::string& path,
                             const Client& client, Answer& answer);

 private:
  bool is_open() const { return token_.empty() && !book_; }
  std::optional<AccessToken> find(std::string_view text);
  void refuse(const Client& client, bool tried, Answer& answer);

  std::string token_;
  std::unique_ptr<TokenBook> book_;
  Throttle throttle_;
};

}  // namespace clipgs
