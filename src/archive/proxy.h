#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "archive/url.h"

namespace clipgs {

/// What stands between a hospital's network and others: requests go through it.
struct Proxy {
  std::string host;
  int port = 1080;
  std::string user;
  std::string password;
};

/// The proxy that the environment names for this address, as curl reads it: https_proxy, http_proxy
/// (in capitals, too, but for the latter, which web servers set), or all_proxy, each as
/// "[http://][USER:PASSWORD@]HOST[:PORT]"; nothing where no_proxy names the host. Throws Error,
/// that does not repeat the text.
std::optional<Proxy> proxy_for(const Url& url);

/// Whether a no_proxy list has the host: "*", names, which stand for all that end so, too,
/// addresses, and networks as "10.0.0.0/8".
bool is_exempt(std::string_view host, std::string_view list);

}  // namespace clipgs
