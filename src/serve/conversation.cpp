#include "serve/conversation.h"

#include <algorithm>
#include <array>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/ssl.hpp>
#include <type_traits>
#include <utility>

namespace clipgs {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;
using boost::system::error_code;

using PlainStream = beast::tcp_stream;
using TlsStream = beast::ssl_stream<beast::tcp_stream>;

constexpr size_t kPiece = size_t{64} << 10;
/// For a client to end what the server has ended.
constexpr std::chrono::seconds kFarewell(2);

asio::redirect_error_t<std::decay_t<decltype(asio::use_awaitable)>> into(error_code& error) {
  return asio::redirect_error(asio::use_awaitable, error);
}

/// Among the open connections for as long as it lives.
class Registration {
 public:
  Registration(Host& host, const std::string& client, std::function<void()> close)
      : host_(host), id_(host.connections.add(client, std::move(close))) {
    host_.site.metrics().connection_opened();
  }
  ~Registration() {
    host_.connections.remove(id_);
    host_.site.metrics().connection_closed();
  }
  Registration(const Registration&) = delete;
  Registration& operator=(const Registration&) = delete;

  void set_answering(bool answering) { host_.connections.set_answering(id_, answering); }

 private:
  Host& host_;
  Connections::Id id_;
};

/// The talk with one client. It ends where the connection is closed, at any point.
template <typename Stream>
class Conversation {
 public:
  Conversation(Host& host, Stream& stream, asio::ip::address peer)
      : host_(host),
        stream_(stream),
        peer_(std::move(peer)),
        timer_(stream.get_executor()),
        registration_(host, network_of(peer_), [this] {
          closed_ = true;
          timer_.cancel();
          socket().close();
        }) {}

  asio::awaitable<void> hold() {
    bool goes_on = true;
    while (goes_on && !closed_) {
      RequestParser parser;
      error_code error;
      socket().expires_after(host_.limits.request);
      co_await beast::http::async_read_header(stream_, buffer_, parser, into(error));
      if (!error && host_.site.wants_body(parser.get())) {
        co_await beast::http::async_read(stream_, buffer_, parser, into(error));
      }
      if (error && error.category() != bad_requests()) {
        co_return;  // gone, or too slow
      }
      if (error == beast::http::error::end_of_stream ||
          error == beast::http::error::partial_message) {
        break;
      }
      const Clock::time_point asked = Clock::now();
      const Client client = host_.proxies.client(peer_, parser.get());
      const Answer answer = co_await asio::co_spawn(
          host_.workers, find_answer(parser.get(), client, error), asio::use_awaitable);
      goes_on = !answer.last;
      co_await wait(answer.delay);
      registration_.set_answering(true);
      const Sent sent = co_await send(answer);
      registration_.set_answering(false);
      co_await asio::co_spawn(
          host_.workers, record({parser.get(), answer, client, sent.bytes, Clock::now() - asked}),
          asio::use_awaitable);
      if (!sent.all) {
        co_return;
      }
    }
    co_await say_goodbye();
  }

 private:
  using Clock = std::chrono::steady_clock;
  /// Of an answer.
  struct Sent {
    std::uint64_t bytes = 0;
    bool all = false;
  };

  static const boost::system::error_category& bad_requests() {
    static const error_code one = beast::http::error::bad_method;
    return one.category();
  }

  beast::tcp_stream& socket() { return beast::get_lowest_layer(stream_); }

  asio::awaitable<Answer> find_answer(const HttpRequest& request, const Client& client,
                                      error_code error) {
    if (error) {
      co_return Site::refuse(error);
    }
    co_return host_.site.answer(request, client);
  }

  asio::awaitable<void> record(Exchange exchange) {
    host_.site.record(exchange);
    co_return;
  }

  asio::awaitable<size_t> read_body(const ByteSource& body, std::uint64_t offset,
                                    std::span<std::uint8_t> out) {
    co_return body.read(offset, out);
  }

  asio::awaitable<void> wait(std::chrono::milliseconds delay) {
    if (delay.count() == 0 || closed_) {
      co_return;
    }
    error_code cancelled;
    timer_.expires_after(delay);
    co_await timer_.async_wait(into(cancelled));
  }

  /// The head with the beginning of the body, then the rest, a piece at a time.
  asio::awaitable<Sent> send(const Answer& answer) {
    const std::string head = head_text(answer.head);
    std::vector<std::uint8_t> piece(head.begin(), head.end());
    size_t filled = piece.size();
    std::uint64_t offset = 0;
    Sent sent;
    for (;;) {
      const size_t size = std::min<std::uint64_t>(kPiece, answer.body.size - offset);
      piece.resize(filled + size);
      if (size > 0) {
        const size_t n = co_await asio::co_spawn(
            host_.workers, read_body(answer.body, offset, std::span(piece).subspan(filled)),
            asio::use_awaitable);
        if (n != size) {
          co_return sent;  // the file was cut off
        }
      }
      offset += size;
      error_code error;
      socket().expires_after(host_.limits.piece);
      sent.bytes += co_await asio::async_write(stream_, asio::buffer(piece), into(error));
      sent.all = !error && !closed_ && offset == answer.body.size;
      if (error || closed_ || sent.all) {
        co_return sent;
      }
      filled = 0;
    }
  }

  /// Lets the client read the last answer: a socket closed with bytes that nobody read would take
  /// it back.
  asio::awaitable<void> say_goodbye() {
    error_code error;
    socket().expires_after(kFarewell);
    if constexpr (std::is_same_v<Stream, TlsStream>) {
      co_await stream_.async_shutdown(into(error));
    }
    socket().socket().shutdown(tcp::socket::shutdown_send, error);
    std::array<std::uint8_t, 4096> ignored{};
    while (!error && !closed_) {
      co_await socket().async_read_some(asio::buffer(ignored), into(error));
    }
  }

  Host& host_;
  Stream& stream_;
  asio::ip::address peer_;
  asio::steady_timer timer_;
  beast::flat_buffer buffer_{RequestParser::kLimit};
  bool closed_ = false;
  Registration registration_;
};

asio::awaitable<void> serve_client(tcp::socket socket, asio::ip::address peer, Host& host) {
  if (host.tls == nullptr) {
    PlainStream stream(std::move(socket));
    Conversation conversation(host, stream, std::move(peer));
    co_await conversation.hold();
    co_return;
  }
  TlsStream stream(beast::tcp_stream(std::move(socket)), *host.tls);
  Conversation conversation(host, stream, std::move(peer));
  error_code error;
  beast::get_lowest_layer(stream).expires_after(host.limits.handshake);
  co_await stream.async_handshake(asio::ssl::stream_base::server, into(error));
  if (!error) {
    co_await conversation.hold();
  }
}

asio::awaitable<void> accept_all(tcp::acceptor& acceptor, Host& host) {
  asio::steady_timer timer(acceptor.get_executor());
  while (acceptor.is_open()) {
    error_code error;
    tcp::socket socket = co_await acceptor.async_accept(into(error));
    error_code gone;
    const tcp::endpoint client = error ? tcp::endpoint() : socket.remote_endpoint(gone);
    if (!error && !gone) {
      socket.set_option(tcp::no_delay(true), gone);
      asio::co_spawn(acceptor.get_executor(),
                     serve_client(std::move(socket), client.address(), host),
                     [](const std::exception_ptr&) {});  // of that connection alone
    } else if (error && error != asio::error::connection_aborted && acceptor.is_open()) {
      // Out of files or memory, most likely: one connection less, and a while for others to end.
      host.connections.close_one();
      timer.expires_after(std::chrono::milliseconds(20));
      co_await timer.async_wait(into(error));
    }
  }
}

}  // namespace

void accept_connections(tcp::acceptor& acceptor, Host& host) {
  asio::co_spawn(acceptor.get_executor(), accept_all(acceptor, host), asio::detached);
}

}  // namespace clipgs
