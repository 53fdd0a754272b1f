#include "archive/proxy.h"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <netinet/in.h>

#include "core/error.h"
#include "core/percent.h"

namespace clipgs {

namespace {

/// The first of these variables that holds something.
std::string from_environment(std::initializer_list<const char*> names) {
  for (const char* name : names) {
    const char* const value = std::getenv(name);
    if (value != nullptr && *value != '\0') {
      return value;
    }
  }
  return "";
}

/// The bytes of an IP address, 4 or 16 of them, and how many bits there are; 0: it is none.
struct Address {
  explicit Address(const std::string& text) {
    if (::inet_pton(AF_INET, text.c_str(), bytes.data()) == 1) {
      bits = 32;
    } else if (::inet_pton(AF_INET6, text.c_str(), bytes.data()) == 1) {
      bits = 128;
    }
  }

  std::array<std::uint8_t, sizeof(in6_addr)> bytes{};
  unsigned bits = 0;
};

/// Whether the address lies in a network "10.0.0.0/8".
bool is_in_network(const std::string& host, std::string_view network) {
  const size_t slash = network.find('/');
  if (slash == std::string_view::npos) {
    return false;
  }
  const Address one(host);
  const Address other{std::string(network.substr(0, slash))};
  unsigned bits = 0;
  const char* const end = network.data() + network.size();
  const auto [rest, error] = std::from_chars(network.data() + slash + 1, end, bits);
  if (one.bits == 0 || one.bits != other.bits || error != std::errc() || rest != end ||
      bits > one.bits) {
    return false;
  }
  for (unsigned bit = 0; bit < bits; ++bit) {
    const unsigned difference = one.bytes.at(bit / 8) ^ other.bytes.at(bit / 8);
    if ((difference >> (7 - bit % 8) & 1U) != 0) {
      return false;
    }
  }
  return true;
}

/// Whether one entry of a no_proxy list, without a dot before it, stands for the host.
bool stands_for(std::string_view entry, const std::string& host) {
  if (entry.empty()) {
    return false;
  }
  const bool ends_so = host.size() > entry.size() && host.ends_with(entry) &&
                       host[host.size() - entry.size() - 1] == '.' && Address(host).bits == 0;
  return entry == "*" || entry == host || ends_so || is_in_network(host, entry);
}

std::string decoded(std::string_view text) {
  return percent_decode(text).value_or(std::string(text));
}

Proxy parse_proxy(std::string text) {
  const size_t scheme = text.find("://");
  if (scheme != std::string::npos) {
    if (text.substr(0, scheme) != "http") {
      throw Error(
          "the proxy in the environment is no http:// one; name one that is in https_proxy");
    }
    text.erase(0, scheme + 3);
  }
  Proxy proxy;
  if (const size_t at = text.rfind('@'); at != std::string::npos) {
    const std::string_view both = std::string_view(text).substr(0, at);
    const size_t colon = std::min(both.find(':'), both.size());
    proxy.user = decoded(both.substr(0, colon));
    proxy.password = decoded(both.substr(std::min(colon + 1, both.size())));
    text.erase(0, at + 1);
  }
  text.resize(std::min(text.find('/'), text.size()));
  const size_t host_end = text.find(']');
  if (text.find(':', host_end == std::string::npos ? 0 : host_end) == std::string::npos) {
    text += fmt::format(":{}", proxy.port);
  }
  try {
    const Url url = parse_url("http://" + text);
    proxy.host = url.host;
    proxy.port = url.port;
  } catch (const Error&) {
    throw Error(
        "the proxy in the environment is no address; set https_proxy to http://proxy.example:3128");
  }
  return proxy;
}

}  // namespace

bool is_exempt(std::string_view host, std::string_view list) {
  const std::string name(host);
  while (!list.empty()) {
    const size_t end = std::min(list.find_first_of(", \t"), list.size());
    std::string_view entry = list.substr(0, end);
    if (entry.starts_with('.')) {
      entry.remove_prefix(1);
    }
    if (stands_for(entry, name)) {
      return true;
    }
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return false;
}

std::optional<Proxy> proxy_for(const Url& url) {
  std::string text =
      url.tls ? from_environment({"https_proxy", "HTTPS_PROXY"}) : from_environment({"http_proxy"});
  if (text.empty()) {
    text = from_environment({"all_proxy", "ALL_PROXY"});
  }
  if (text.empty() || is_exempt(url.host, from_environment({"no_proxy", "NO_PROXY"}))) {
    return std::nullopt;
  }
  return parse_proxy(text);
}

}  // namespace clipgs
