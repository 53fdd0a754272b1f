#include "serve/client.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <ranges>
#include <string_view>

#include "core/error.h"
#include "core/letter_case.h"
#include "serve/http.h"

namespace clipgs {

namespace {

namespace asio = boost::asio;
using asio::ip::address;
using asio::ip::address_v4;
using asio::ip::address_v6;

constexpr unsigned kBits = 128;
constexpr unsigned kBitsBeforeV4 = 96;

/// IPv4 addresses as IPv6 ones, so that there is one kind.
address_v6::bytes_type bytes_of(const address& one) {
  return one.is_v6() ? one.to_v6().to_bytes()
                     : asio::ip::make_address_v6(asio::ip::v4_mapped, one.to_v4()).to_bytes();
}

/// The reverse, where it is one.
address plain(const address& one) {
  return one.is_v6() && one.to_v6().is_v4_mapped()
             ? address(asio::ip::make_address_v4(asio::ip::v4_mapped, one.to_v6()))
             : one;
}

/// "10.1.2.3", "10.1.2.3:4711", "2001:db8::1", "[2001:db8::1]:4711", also in quotes; nothing of
/// "unknown", "_hidden" and what else is no address.
std::optional<address> address_in(std::string_view text) {
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
    text = text.substr(1, text.size() - 2);
  }
  if (text.starts_with('[')) {
    const size_t end = text.find(']');
    text = end == std::string_view::npos ? std::string_view() : text.substr(1, end - 1);
  } else if (std::ranges::count(text, ':') == 1) {
    text = text.substr(0, text.find(':'));
  }
  boost::system::error_code error;
  const address one = asio::ip::make_address(std::string(text), error);
  return error ? std::nullopt : std::optional(plain(one));
}

/// The value of "for" in an element of a Forwarded header; "" without one.
std::string_view for_of(std::string_view element) {
  for (const std::string_view pair : header_list(element, ';')) {
    const size_t equals = pair.find('=');
    if (equals != std::string_view::npos && is_alike(pair.substr(0, equals), "for")) {
      return pair.substr(equals + 1);
    }
  }
  return {};
}

/// The elements of all headers of that name.
std::vector<std::string_view> elements_of(const HttpRequest& request, const char* name) {
  std::vector<std::string_view> all;
  const auto [begin, end] = request.equal_range(name);
  for (auto it = begin; it != end; ++it) {
    const std::vector<std::string_view> some =
        header_list({it->value().data(), it->value().size()}, ',');
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

/// For whom proxies say that they ask, the first of them first.
std::vector<std::string_view> hops_of(const HttpRequest& request) {
  std::vector<std::string_view> hops = elements_of(request, "X-Forwarded-For");
  if (hops.empty()) {
    hops = elements_of(request, "Forwarded");
    std::ranges::transform(hops, hops.begin(), for_of);
  }
  return hops;
}

}  // namespace

std::string network_of(const address& one) {
  const address known = plain(one);
  if (known.is_v4()) {
    return known.to_string();
  }
  address_v6::bytes_type bytes = known.to_v6().to_bytes();
  std::fill(bytes.begin() + 8, bytes.end(), std::uint8_t{0});
  return address_v6(bytes).to_string();
}

TrustedProxies::TrustedProxies(const std::vector<std::string>& addresses) {
  for (const std::string& text : addresses) {
    const size_t slash = std::min(text.find('/'), text.size());
    boost::system::error_code error;
    const address one = asio::ip::make_address(text.substr(0, slash), error);
    const unsigned most = !error && one.is_v4() ? kBits - kBitsBeforeV4 : kBits;
    unsigned bits = most;
    if (!error && slash < text.size()) {
      const char* const end = text.data() + text.size();
      const auto [rest, what] = std::from_chars(text.data() + slash + 1, end, bits);
      bits = what == std::errc() && rest == end ? bits : most + 1;
    }
    if (error || bits > most) {
      throw Error("--trusted-proxy {}: is no address; give one as 127.0.0.1 or 10.1.0.0/16", text);
    }
    networks_.push_back({bytes_of(one), bits + kBits - most});
  }
}

bool TrustedProxies::trusts(const address& one) const {
  const address_v6::bytes_type bytes = bytes_of(one);
  return std::ranges::any_of(networks_, [&](const Network& network) {
    const unsigned whole = network.bits / 8;
    const unsigned rest = network.bits % 8;
    const bool same = std::equal(bytes.begin(), bytes.begin() + whole, network.bytes.begin());
    return same && (rest == 0 || ((bytes.at(whole) ^ network.bytes.at(whole)) >> (8 - rest)) == 0);
  });
}

Client TrustedProxies::client(const address& peer, const HttpRequest& request) const {
  address one = plain(peer);
  const std::vector<std::string_view> hops = hops_of(request);
  const bool is_local = one.is_loopback() && !trusts(one) && hops.empty();
  for (const std::string_view hop : hops | std::views::reverse) {
    const std::optional<address> before = trusts(one) ? address_in(hop) : std::nullopt;
    if (!before) {
      break;
    }
    one = *before;
  }
  return {one.to_string(), network_of(one), is_local};
}

}  // namespace clipgs
