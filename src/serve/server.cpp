#include "serve/server.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <cerrno>

#include "core/error.h"
#include "serve/conversation.h"
#include "serve/http.h"
#include "serve/site.h"

namespace clipgs {

namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

/// What is on its way to a client. Larger ones would keep slow clients' answers in memory, and hide
/// whether they are taken; this one lasts for 50 Mbit/s at 40 ms.
constexpr int kSendBuffer = 256 << 10;

void set_up(asio::ssl::context& context, const Certificate& certificate) {
  if (!use_certificate(*context.native_handle(), certificate) ||
      SSL_CTX_set_min_proto_version(context.native_handle(), TLS1_2_VERSION) != 1) {
    throw Error(
        "the server's certificate is of no use to OpenSSL; remove it, and a new one is made");
  }
  SSL_CTX_set_options(context.native_handle(), SSL_OP_NO_RENEGOTIATION);
}

/// The first of the addresses that `host` means.
tcp::endpoint endpoint_of(asio::io_context& io, const std::string& host, int port) {
  error_code error;
  tcp::resolver resolver(io);
  const auto found = resolver.resolve(host, std::to_string(port), tcp::resolver::passive, error);
  if (error || found.empty()) {
    throw Error("{}:{}: cannot listen there ({}); choose another --host or --port", host, port,
                error ? error.message() : "no such address");
  }
  return found.begin()->endpoint();
}

void listen(tcp::acceptor& acceptor, const tcp::endpoint& at, const std::string& host, int port) {
  error_code error;
  acceptor.open(at.protocol(), error);
  if (!error) {
    acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  }
  if (!error) {
    acceptor.set_option(asio::socket_base::send_buffer_size(kSendBuffer), error);
  }
  if (!error) {
    acceptor.bind(at, error);
  }
  if (!error) {
    acceptor.listen(asio::socket_base::max_listen_connections, error);
  }
  if (error == asio::error::address_in_use) {
    throw Error("{}:{}: the port is taken; choose another with --port, or any with --port 0", host,
                port);
  }
  if (error) {
    throw Error("{}:{}: cannot listen there ({}); choose another --host or --port", host, port,
                error.message());
  }
}

/// Of "https://host:port/"; "" of "".
std::string host_of_url(const std::string& url) {
  if (url.empty()) {
    return "";
  }
  const size_t scheme = url.find("://");
  const size_t begin = scheme == std::string::npos ? url.size() : scheme + 3;
  const size_t end = url.find('/', begin);
  const auto host = host_name(std::string_view(url).substr(begin, end - begin));
  const bool is_http = url.starts_with("http://") || url.starts_with("https://");
  if (!is_http || !host || end != url.size() - 1) {
    throw Error("{}: is no address to open; give one as https://cases.hospital.example/", url);
  }
  return *host;
}

bool is_local(const asio::ip::address& address) { return is_loopback(address.to_string()); }

}  // namespace

class Server::Implementation {
 public:
  explicit Implementation(ServerOptions options) : options_(std::move(options)), acceptor_(io_) {
    if (options_.identity) {
      set_up(tls_, options_.identity->certificate);
    }
    listen(acceptor_, endpoint_of(io_, options_.host, options_.port), options_.host, options_.port);
    const tcp::endpoint bound = acceptor_.local_endpoint();
    port_ = bound.port();
    local_ = clipgs::is_local(bound.address());
    TrustedProxies proxies(options_.proxies);
    if (!proxies.empty()) {
      // All come by them.
      options_.limits.per_client = options_.limits.all;
    }
    site_ = std::make_unique<Site>(site_options());
    host_ = std::make_unique<Host>(*site_, options_.limits, std::move(proxies),
                                   options_.identity ? &tls_ : nullptr);
    accept_connections(acceptor_, *host_);
  }

  ~Implementation() { host_->workers.join(); }  // what they do ends in conversations
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  int port() const { return port_; }
  bool is_local() const { return local_; }
  std::string url_at(const std::string& host) const {
    return (options_.public_url.empty() ? origin(host) : options_.public_url) + token();
  }
  std::string url() const { return url_at(options_.host); }
  Site& site() { return *site_; }

  void run() {
    io_.run();
    host_->workers.join();
  }

  void stop() {
    asio::post(io_, [this] {
      error_code ignored;
      acceptor_.close(ignored);
      host_->connections.close_all();
    });
  }

 private:
  std::string token() const {
    return options_.identity && options_.tokens.empty() ? options_.identity->token : "";
  }

  SiteOptions site_options() const {
    SiteOptions site;
    site.folder = options_.folder;
    site.token = token();
    site.url = options_.public_url.empty() ? origin(options_.host) : options_.public_url;
    site.study = options_.study;
    site.only = options_.only;
    site.live = options_.live;
    site.keeps = options_.keeps;
    site.subfolders = options_.subfolders || !options_.tokens.empty();
    site.tokens = options_.tokens;
    site.access_log = options_.access_log;
    site.audit = options_.audit;
    site.public_name = host_of_url(options_.public_url);
    if (local_) {
      site.local_name = host_name(options_.host).value_or("localhost");
    }
    return site;
  }

  std::string origin(const std::string& host) const {
    const bool v6 = host.find(':') != std::string::npos;
    return fmt::format("{}://{}{}{}:{}/", options_.identity ? "https" : "http", v6 ? "[" : "", host,
                       v6 ? "]" : "", port_);
  }

  ServerOptions options_;
  int port_ = 0;
  bool local_ = false;
  asio::ssl::context tls_{asio::ssl::context::tls_server};
  std::unique_ptr<Site> site_;
  std::unique_ptr<Host> host_;
  // Ends before what its conversations use. One thread: none of that needs a lock.
  asio::io_context io_{1};
  tcp::acceptor acceptor_;
};

Server::Server(const ServerOptions& options)
    : implementation_(std::make_unique<Implementation>(options)) {}

Server::~Server() = default;

int Server::port() const { return implementation_->port(); }

bool Server::is_local() const { return implementation_->is_local(); }

std::string Server::url() const { return implementation_->url(); }

std::string Server::url_at(const std::string& host) const { return implementation_->url_at(host); }

size_t Server::case_count() const {
  return implementation_->site().cases().count().value_or(Metrics::Cases()).shown;
}

size_t Server::broken_count() const {
  return implementation_->site().cases().count().value_or(Metrics::Cases()).broken;
}

void Server::run() { implementation_->run(); }

void Server::stop() { implementation_->stop(); }

void Server::reopen_logs() { implementation_->site().reopen_logs(); }

}  // namespace clipgs
