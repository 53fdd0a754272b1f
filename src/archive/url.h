#pragma once

#include <string>
#include <string_view>

namespace clipgs {

/// Where an HTTP request goes.
struct Url {
  bool tls = true;   ///< https
  std::string host;  ///< a name or an address, IPv6 ones without brackets
  int port = 443;
  std::string path;  ///< with the query, percent-encoded; begins with "/" unless it is empty

  /// Same scheme, host and port: whoever may know a secret.
  bool is_same_place(const Url& other) const;
  /// "archive.example:8042", without a scheme's own port: what errors say of it.
  std::string place() const;
};

/// "https://HOST[:PORT][/PATH]", or http. Throws Error, also of a user or password in it, which
/// would be on a command line and in logs; the error never repeats the text.
Url parse_url(std::string_view text);

/// Where a Location header (RFC 9110, 10.2.2) of an answer from `from` leads to. Throws Error.
Url redirected(const Url& from, std::string_view location);

/// Whether the host is this machine, as far as its name or address says.
bool is_this_machine(const Url& url);

}  // namespace clipgs
