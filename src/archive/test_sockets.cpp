#include "archive/test_sockets.h"

#include <array>
#include <csignal>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <openssl/ssl.h>
#include <poll.h>
#include <pthread.h>
#include <stdexcept>
#include <sys/socket.h>
#include <unistd.h>

namespace clipgs::testing_support {

namespace {

sockaddr_in loopback(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return address;
}

int port_of(int socket) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

int bound_socket() {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const sockaddr_in address = loopback(0);
  if (::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    throw std::runtime_error("no free port");
  }
  return socket;
}

/// Else what is passed on in two pieces waits for an acknowledgement in between.
void send_at_once(int socket) {
  const int on = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

/// Waits until one of them can be read.
std::array<bool, 2> readable(int one, int other) {
  std::array<pollfd, 2> both{{{one, POLLIN, 0}, {other, POLLIN, 0}}};
  ::poll(both.data(), both.size(), -1);
  return {both[0].revents != 0, both[1].revents != 0};
}

using Context = std::shared_ptr<SSL_CTX>;
using Connection = std::unique_ptr<SSL, decltype(&SSL_free)>;

Context gate_context(const std::filesystem::path& certificate,
                     const std::filesystem::path& client_authorities) {
  Context context(SSL_CTX_new(TLS_server_method()), SSL_CTX_free);
  if (SSL_CTX_use_certificate_chain_file(context.get(), certificate.c_str()) != 1 ||
      SSL_CTX_use_PrivateKey_file(context.get(), certificate.c_str(), SSL_FILETYPE_PEM) != 1) {
    throw std::runtime_error("no certificate in " + certificate.string());
  }
  if (!client_authorities.empty()) {
    SSL_CTX_load_verify_locations(context.get(), client_authorities.c_str(), nullptr);
    SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER | SSL_VERIFY_FAIL_IF_NO_PEER_CERT, nullptr);
  }
  return context;
}

/// Decrypted bytes to `server`, and its answers back.
void serve_tls(SSL* outside, int server) {
  std::array<char, 1 << 14> buffer{};
  for (;;) {
    const auto [from_outside, from_server] =
        SSL_pending(outside) > 0 ? std::array{true, false} : readable(SSL_get_fd(outside), server);
    if (from_outside) {
      const int size = SSL_read(outside, buffer.data(), static_cast<int>(buffer.size()));
      if (size <= 0 || !send_all(server, {buffer.data(), static_cast<size_t>(size)})) {
        return;
      }
    }
    if (from_server) {
      const ssize_t size = ::recv(server, buffer.data(), buffer.size(), 0);
      if (size <= 0 || SSL_write(outside, buffer.data(), static_cast<int>(size)) <= 0) {
        SSL_shutdown(outside);
        return;
      }
    }
  }
}

/// A socket that is closed while something is unread takes back what was sent, an alert as well.
void wait_for_end(int socket) {
  ::shutdown(socket, SHUT_WR);
  std::array<char, 1 << 10> ignored{};
  while (::recv(socket, ignored.data(), ignored.size(), 0) > 0) {
  }
}

}  // namespace

int free_port() {
  const int socket = bound_socket();
  const int port = port_of(socket);
  ::close(socket);
  return port;
}

int connect_to(int port) {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const sockaddr_in address = loopback(port);
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    ::close(socket);
    return -1;
  }
  send_at_once(socket);
  return socket;
}

bool send_all(int socket, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) {
      return false;
    }
    bytes.remove_prefix(static_cast<size_t>(sent));
  }
  return true;
}

std::string read_head(int socket) {
  std::string head;
  char byte = 0;
  while (!head.ends_with("\r\n\r\n") && ::recv(socket, &byte, 1, 0) == 1) {
    head += byte;
  }
  return head;
}

SocketServer::SocketServer(std::function<void(int socket)> serve)
    : serve_(std::move(serve)), listener_(bound_socket()), port_(port_of(listener_)) {
  ::listen(listener_, SOMAXCONN);
  runner_ = std::thread([this] { run(); });
}

SocketServer::~SocketServer() {
  ::shutdown(listener_, SHUT_RDWR);
  runner_.join();
  {
    const std::scoped_lock lock(mutex_);
    for (const int socket : open_) {
      ::shutdown(socket, SHUT_RDWR);
    }
  }
  for (std::thread& thread : threads_) {
    thread.join();
  }
  ::close(listener_);
}

void SocketServer::run() {
  sigset_t pipe{};  // OpenSSL writes to connections that may be closed; the threads inherit this
  sigemptyset(&pipe);
  sigaddset(&pipe, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &pipe, nullptr);
  for (;;) {
    const int socket = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (socket < 0) {
      return;
    }
    send_at_once(socket);
    const std::scoped_lock lock(mutex_);
    open_.insert(socket);
    threads_.emplace_back([this, socket] {
      serve_(socket);
      end(socket);
    });
  }
}

void SocketServer::end(int socket) {
  const std::scoped_lock lock(mutex_);
  open_.erase(socket);
  ::close(socket);
}

void tunnel(int one, int other, std::uint64_t most) {
  std::array<char, 1 << 14> buffer{};
  std::uint64_t answered = 0;
  while (answered < most) {
    const auto [from_one, from_other] = readable(one, other);
    for (const auto& [ready, from, to] :
         {std::tuple{from_one, one, other}, std::tuple{from_other, other, one}}) {
      if (ready) {
        const ssize_t size = ::recv(from, buffer.data(), buffer.size(), 0);
        if (size <= 0 || !send_all(to, {buffer.data(), static_cast<size_t>(size)})) {
          return;
        }
        answered += from == other ? static_cast<std::uint64_t>(size) : 0;
      }
    }
  }
}

std::unique_ptr<SocketServer> make_tls_gate(int server, const std::filesystem::path& certificate,
                                            const std::filesystem::path& client_authorities) {
  return std::make_unique<SocketServer>(
      [server, context = gate_context(certificate, client_authorities)](int socket) {
        const Connection outside(SSL_new(context.get()), SSL_free);
        SSL_set_fd(outside.get(), socket);
        if (SSL_accept(outside.get()) != 1) {
          wait_for_end(socket);
          return;
        }
        const int inside = connect_to(server);
        if (inside >= 0) {
          serve_tls(outside.get(), inside);
          ::close(inside);
        }
      });
}

}  // namespace clipgs::testing_support
