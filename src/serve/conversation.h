#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/thread_pool.hpp>
#include <utility>

#include "serve/client.h"
#include "serve/connections.h"
#include "serve/site.h"

namespace clipgs {

/// What the conversations with all clients have in common.
struct Host {
  Host(Site& what, const ConnectionLimits& most, TrustedProxies between,
       boost::asio::ssl::context* with)
      : site(what), limits(most), proxies(std::move(between)), tls(with), connections(most) {}

  Site& site;
  ConnectionLimits limits;
  TrustedProxies proxies;
  boost::asio::ssl::context* tls;  ///< null: not encrypted
  Connections connections;
  /// Files are read here, where disks may be slow: conversations share one thread.
  boost::asio::thread_pool workers{4};
};

/// Starts to take connections and to answer what they ask, until the acceptor is closed. Everything
/// happens in its execution context, which must be run by one thread; `host` must live as long.
void accept_connections(boost::asio::ip::tcp::acceptor& acceptor, Host& host);

}  // namespace clipgs
