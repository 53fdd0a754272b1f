#pragma once

#include <boost/asio/ip/address.hpp>
#include <string>
#include <vector>

#include "serve/answer.h"

namespace clipgs {

/// Who asks.
struct Client {
  std::string address;    ///< as logs say it
  std::string network;    ///< see network_of()
  bool is_local = false;  ///< this machine itself, and no proxy as far as can be told
};

/// What the connections from one place have in common: an IPv4 address, or the network of an IPv6
/// address (/64), all of whose addresses are one machine's to choose from.
std::string network_of(const boost::asio::ip::address& one);

/// The reverse proxies that are believed when they say for whom they ask.
class TrustedProxies {
 public:
  /// Addresses, or networks as "10.1.0.0/16". Throws Error.
  explicit TrustedProxies(const std::vector<std::string>& addresses = {});

  bool empty() const { return networks_.empty(); }

  /// Who asks by a connection from `peer`: behind proxies that are trusted the last address of
  /// X-Forwarded-For (or, where there is none, of Forwarded, RFC 7239) that is not one of them,
  /// whatever somebody wrote before it; else `peer`.
  Client client(const boost::asio::ip::address& peer, const HttpRequest& request) const;

 private:
  struct Network {
    boost::asio::ip::address_v6::bytes_type bytes;
    unsigned bits;
  };

  bool trusts(const boost::asio::ip::address& one) const;

  std::vector<Network> networks_;
};

}  // namespace clipgs
