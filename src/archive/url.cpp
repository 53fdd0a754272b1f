#include "archive/url.h"

#include <algorithm>
#include <arpa/inet.h>
#include <cctype>
#include <charconv>
#include <netinet/in.h>

#include "core/error.h"
#include "core/letter_case.h"

namespace clipgs {

namespace {

constexpr int kHttpPort = 80;
constexpr int kHttpsPort = 443;
constexpr size_t kMostText = 2048;  // bytes
constexpr int kMostPort = 65535;

[[noreturn]] void refuse() {
  throw Error("the archive's address is none; give one as https://archive.example:8443/dicom-web");
}

bool is_name(std::string_view host) {
  return !host.empty() && std::ranges::all_of(host, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '.' || c == '-' || c == '_';
  });
}

bool is_ipv6(const std::string& host) {
  in6_addr ignored{};
  return ::inet_pton(AF_INET6, host.c_str(), &ignored) == 1;
}

int port_in(std::string_view text) {
  int port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (error != std::errc() || end != text.data() + text.size() || port < 1 || port > kMostPort) {
    refuse();
  }
  return port;
}

/// "HOST[:PORT]".
void read_authority(std::string_view text, Url& url) {
  if (text.find('@') != std::string_view::npos) {
    throw Error(
        "the archive's address has a user or a password in it, which others would see; take them "
        "out and give --user and --password-file");
  }
  std::string_view port;
  if (text.starts_with('[')) {
    const size_t end = std::min(text.find(']'), text.size());
    url.host = text.substr(1, end - 1);
    port = text.substr(std::min(end + 1, text.size()));
    if (!is_ipv6(url.host)) {
      refuse();
    }
  } else {
    const size_t colon = std::min(text.find(':'), text.size());
    url.host = lower_case(text.substr(0, colon));
    port = text.substr(colon);
    if (!is_name(url.host)) {
      refuse();
    }
  }
  if (!port.empty()) {
    if (port.front() != ':') {
      refuse();
    }
    url.port = port_in(port.substr(1));
  }
}

}  // namespace

bool Url::is_same_place(const Url& other) const {
  return tls == other.tls && host == other.host && port == other.port;
}

std::string Url::place() const {
  const std::string name = host.find(':') == std::string::npos ? host : "[" + host + "]";
  return port == (tls ? kHttpsPort : kHttpPort) ? name : fmt::format("{}:{}", name, port);
}

Url parse_url(std::string_view text) {
  const bool is_plain = text.size() <= kMostText && std::ranges::all_of(text, [](unsigned char c) {
                          return std::isgraph(c) != 0 && c != '#' && c != '"' && c != '\\';
                        });
  const size_t begin = text.find("://");
  if (!is_plain || begin == std::string_view::npos) {
    refuse();
  }
  const std::string scheme = lower_case(text.substr(0, begin));
  if (scheme != "https" && scheme != "http") {
    refuse();
  }
  Url url;
  url.tls = scheme == "https";
  url.port = url.tls ? kHttpsPort : kHttpPort;
  const std::string_view rest = text.substr(begin + 3);
  const size_t end = std::min(rest.find_first_of("/?"), rest.size());
  read_authority(rest.substr(0, end), url);
  url.path = rest.substr(end);
  if (url.path.starts_with('?')) {
    url.path.insert(0, "/");
  }
  return url;
}

Url redirected(const Url& from, std::string_view location) {
  if (!location.starts_with('/') || location.starts_with("//")) {
    return parse_url(location);
  }
  const std::string place = fmt::format("{}://{}", from.tls ? "https" : "http", from.place());
  return parse_url(place + std::string(location));
}

bool is_this_machine(const Url& url) {
  return url.host == "localhost" || url.host == "::1" ||
         (url.host.starts_with("127.") && ::inet_addr(url.host.c_str()) != INADDR_NONE);
}

}  // namespace clipgs
