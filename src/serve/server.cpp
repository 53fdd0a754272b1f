#include "serve/server.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <httplib.h>
#include <nlohmann/json.hpp>
#include <openssl/crypto.h>
#include <openssl/ssl.h>
#include <sys/socket.h>
#include <thread>

#include "core/error.h"
#include "serve/case_index.h"
#include "serve/http.h"
#include "serve/viewer_bundle.h"

namespace clipgs {

namespace {

using httplib::Request;
using httplib::Response;

constexpr int kNotModified = 304;
constexpr int kForbidden = 403;
constexpr int kNotFound = 404;
constexpr int kMethodNotAllowed = 405;
constexpr int kRangeNotSatisfiable = 416;
constexpr int kNoCase = 422;

constexpr const char* kCookie = "__Host-clipgs";
constexpr const char* kText = "text/plain; charset=utf-8";
constexpr const char* kCasePrefix = "/cases/";
constexpr const char* kCaseSuffix = ".sog";
constexpr const char* kThumbnailSuffix = "/thumbnail";
constexpr const char* kAlwaysAsk = "no-cache";  // kept, but checked by its ETag before use
constexpr const char* kForEver = "public, max-age=31536000, immutable";

/// Isolation for SharedArrayBuffer, and nothing from elsewhere: the page works without the
/// internet.
httplib::Headers default_headers() {
  return {
      {"Cross-Origin-Opener-Policy", "same-origin"},
      {"Cross-Origin-Embedder-Policy", "require-corp"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
      {"X-Content-Type-Options", "nosniff"},
      {"Referrer-Policy", "no-referrer"},
      {"Content-Security-Policy",
       "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self' "
       "'unsafe-inline'; "
       "img-src 'self' blob: data:; connect-src 'self' data:"},
  };
}

/// The library applies the request's ranges to whatever a handler gives, without checking them
/// against its size, and hands out the request as const although it is its own local variable.
void set_ranges(const Request& request, httplib::Ranges ranges) {
  const_cast<Request&>(request).ranges = std::move(ranges);
}

void fail(Response& response, int status, const std::string& message) {
  response.status = status;
  response.set_header("Cache-Control", "no-store");
  response.set_content(message + "\n", kText);
}

/// Bytes that live as long as the program, or as `owner`.
void give(Response& response, std::string_view bytes, const char* type,
          std::shared_ptr<const void> owner = nullptr) {
  response.set_content_provider(
      bytes.size(), type,
      [bytes, owner = std::move(owner)](size_t offset, size_t length, httplib::DataSink& sink) {
        sink.write(bytes.data() + offset, length);
        return true;
      });
}

/// Whether the browser already has what `etag` names; then it is told so.
bool not_modified(const Request& request, Response& response, const std::string& etag) {
  response.set_header("ETag", etag);
  if (!request.has_header("If-None-Match") ||
      !etag_matches(request.get_header_value("If-None-Match"), etag)) {
    return false;
  }
  response.status = kNotModified;
  return true;
}

void give_case(const Request& request, const httplib::Ranges& ranges, Response& response,
               const CaseEntry& entry) {
  const auto file = std::make_shared<OpenFile>(entry.path);
  if (!file->is_open()) {
    fail(response, kNotFound, entry.name + ".sog: is no longer there; choose another case");
    return;
  }
  const FileState& state = file->state();
  const std::string etag = '"' + state.version + '"';
  response.set_header("Cache-Control", kAlwaysAsk);
  response.set_header("Accept-Ranges", "bytes");
  if (not_modified(request, response, etag)) {
    return;
  }
  // If-Range: a range of another version is of no use, so the whole file is given.
  const bool other = request.has_header("If-Range") && request.get_header_value("If-Range") != etag;
  if (!ranges.empty() && !other) {
    const std::optional<ByteRange> range = satisfiable_range(ranges, state.size);
    if (!range) {
      response.set_header("Content-Range", "bytes */" + std::to_string(state.size));
      fail(response, kRangeNotSatisfiable, entry.name + ".sog: has no such range of bytes");
      return;
    }
    set_ranges(request, {*range});
  }
  response.set_content_provider(state.size, "application/octet-stream",
                                [file](size_t offset, size_t length, httplib::DataSink& sink) {
                                  constexpr size_t kPiece = size_t{256} << 10;
                                  std::vector<char> piece(std::min(length, kPiece));
                                  const size_t n = file->read(offset, piece.data(), piece.size());
                                  return n > 0 && sink.write(piece.data(), n);
                                });
}

void give_thumbnail(const Request& request, Response& response,
                    const std::shared_ptr<const CaseEntry>& entry) {
  const Bytes& bytes = entry->info.thumbnail;
  if (bytes.empty()) {
    fail(response, kNotFound, entry->name + ".sog: has no thumbnail");
    return;
  }
  response.set_header("Cache-Control", request.has_param("v") ? kForEver : kAlwaysAsk);
  if (!not_modified(request, response, "\"t" + entry->version + '"')) {
    give(response, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "image/webp",
         entry);
  }
}

/// "NAME.sog" and "NAME/thumbnail" of what follows /cases/. Names are looked up, never used as
/// paths.
void give_of_case(const Request& request, const httplib::Ranges& ranges, Response& response,
                  CaseIndex& index) {
  const std::string_view rest = std::string_view(request.path).substr(strlen(kCasePrefix));
  const bool thumbnail = rest.ends_with(kThumbnailSuffix);
  const std::string_view suffix = thumbnail ? kThumbnailSuffix : kCaseSuffix;
  const std::string name(rest.substr(0, rest.size() - std::min(suffix.size(), rest.size())));
  const auto entry = rest.ends_with(suffix) ? index.find(name) : nullptr;
  if (entry == nullptr) {
    fail(response, kNotFound, "there is no such case; choose another from the menu");
  } else if (!entry->error.empty()) {
    fail(response, kNoCase, entry->error);
  } else if (thumbnail) {
    give_thumbnail(request, response, entry);
  } else {
    give_case(request, ranges, response, *entry);
  }
}

void give_viewer(const Request& request, Response& response) {
  if (viewer_files().empty()) {
    fail(response, kNotFound,
         "this clipgs was built without its viewer; install nodejs, npm and clang-19 and build it "
         "again");
    return;
  }
  const std::string_view path = request.path == "/" ? std::string_view("index.html")
                                                    : std::string_view(request.path).substr(1);
  const auto files = viewer_files();
  const auto file = std::ranges::find(files, path, &ViewerFile::path);
  if (file == files.end()) {
    fail(response, kNotFound, "there is no such page; the viewer is at /");
    return;
  }
  // The names of assets hold a hash of their contents; a new program has a new index.html.
  const bool named_by_content = path.starts_with("assets/");
  response.set_header("Cache-Control", named_by_content ? kForEver : kAlwaysAsk);
  give(response, file->bytes, content_type(path));
}

std::unique_ptr<httplib::Server> make_server(const ServerOptions& options) {
  if (!options.identity) {
    return std::make_unique<httplib::Server>();
  }
  const Certificate& certificate = options.identity->certificate;
  auto server = std::make_unique<httplib::SSLServer>([&](SSL_CTX& context) {
    return use_certificate(context, certificate) &&
           SSL_CTX_set_min_proto_version(&context, TLS1_2_VERSION) == 1;
  });
  if (!server->is_valid()) {
    throw Error(
        "the server's certificate is of no use to OpenSSL; remove it, and a new one is made");
  }
  return server;
}

bool is_secret(std::string_view given, std::string_view secret) {
  return given.size() == secret.size() &&
         CRYPTO_memcmp(given.data(), secret.data(), secret.size()) == 0;
}

/// What a cookie of the request is, or nothing.
std::string_view cookie(std::string_view header, std::string_view name) {
  while (!header.empty()) {
    const size_t end = std::min(header.find("; "), header.size());
    const std::string_view one = header.substr(0, end);
    if (one.starts_with(name) && one.substr(name.size()).starts_with('=')) {
      return one.substr(name.size() + 1);
    }
    header.remove_prefix(std::min(header.size(), end + 2));
  }
  return {};
}

}  // namespace

class Server::Implementation {
 public:
  explicit Implementation(const ServerOptions& options)
      : options_(options), index_(options.folder), http_(make_server(options)) {
    http_->set_default_headers(default_headers());
    http_->set_tcp_nodelay(true);
    // Browsers open six connections at a time, and each keeps a thread while it is open.
    http_->new_task_queue = [] { return new httplib::ThreadPool(32); };
    http_->set_keep_alive_max_count(1000);
    http_->set_keep_alive_timeout(2);
    // The library's default, SO_REUSEPORT, would let two servers share a port unnoticed.
    http_->set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    });
    http_->set_pre_routing_handler([this](const Request& request, Response& response) {
      answer(request, response);
      return httplib::Server::HandlerResponse::Handled;
    });
    bind();
  }

  int port() const { return port_; }
  std::string url() const { return url_at(options_.host); }
  std::string url_at(const std::string& host) const {
    const bool v6 = host.find(':') != std::string::npos;
    const bool secure = options_.identity.has_value();
    return fmt::format("{}://{}{}{}:{}/{}", secure ? "https" : "http", v6 ? "[" : "", host,
                       v6 ? "]" : "", port_, secure ? options_.identity->token : "");
  }
  CaseIndex& index() { return index_; }

  void run() {
    started_ = true;
    if (!stopped_ && !http_->listen_after_bind() && !stopped_) {
      finished_ = true;
      throw Error("{}:{}: listening failed ({})", options_.host, port_, std::strerror(errno));
    }
    finished_ = true;
  }

  void stop() {
    stopped_ = true;
    // A server that is just starting cannot be stopped yet.
    while (started_ && !finished_ && !http_->is_running()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    http_->stop();
  }

 private:
  void bind() {
    errno = 0;
    port_ = options_.port;
    if (options_.port == 0) {
      port_ = http_->bind_to_any_port(options_.host);
    } else if (!http_->bind_to_port(options_.host, options_.port)) {
      port_ = -1;
    }
    if (port_ > 0) {
      return;
    }
    if (errno == EADDRINUSE) {
      throw Error("{}:{}: the port is taken; choose another with --port, or any with --port 0",
                  options_.host, options_.port);
    }
    throw Error("{}:{}: cannot listen there ({}); choose another --host or --port", options_.host,
                options_.port, errno != 0 ? std::strerror(errno) : "no such address");
  }

  void answer(const Request& request, Response& response) {
    const httplib::Ranges ranges = request.ranges;
    set_ranges(request, {});  // only a case has ranges
    if (is_loopback(options_.host) && !is_loopback(host_name(request.get_header_value("Host")))) {
      fail(response, kForbidden, "open this server by its own address, " + url());
    } else if (options_.identity && !may_enter(options_.identity->token, request, response)) {
      // answered
    } else if (request.method != "GET" && request.method != "HEAD") {
      response.set_header("Allow", "GET, HEAD");
      response.set_header("Connection", "close");  // a body may follow that nobody reads
      fail(response, kMethodNotAllowed, "this server only gives; use GET");
    } else if (request.path.starts_with(kCasePrefix)) {
      give_of_case(request, ranges, response, index_);
    } else if (request.path == "/api/cases") {
      response.set_header("Cache-Control", "no-store");
      response.set_content(case_index_json(index_.list())
                               .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace),
                           "application/json");
    } else {
      give_viewer(request, response);
    }
  }

  /// Whether the request has the token; one that brings it in its address is sent on without it.
  static bool may_enter(const std::string& token, const Request& request, Response& response) {
    if (is_secret(cookie(request.get_header_value("Cookie"), kCookie), token)) {
      return true;
    }
    if (is_secret(std::string_view(request.path).substr(1), token)) {
      constexpr int kFound = 302;
      response.status = kFound;
      response.set_header("Location", "/");
      response.set_header("Cache-Control", "no-store");
      response.set_header(
          "Set-Cookie",
          fmt::format("{}={}; Path=/; Secure; HttpOnly; SameSite=Strict; Max-Age=31536000", kCookie,
                      token));
    } else {
      fail(response, kForbidden,
           "open the whole address that clipgs serve printed, with the letters at its end");
    }
    return false;
  }

  ServerOptions options_;
  CaseIndex index_;
  std::unique_ptr<httplib::Server> http_;
  int port_ = -1;
  std::atomic<bool> started_ = false;
  std::atomic<bool> stopped_ = false;
  std::atomic<bool> finished_ = false;
};

Server::Server(const ServerOptions& options)
    : implementation_(std::make_unique<Implementation>(options)) {}

Server::~Server() = default;

int Server::port() const { return implementation_->port(); }

std::string Server::url() const { return implementation_->url(); }

std::string Server::url_at(const std::string& host) const { return implementation_->url_at(host); }

size_t Server::case_count() const {
  const CaseEntries entries = implementation_->index().list();
  return static_cast<size_t>(
      std::ranges::count_if(entries, [](const auto& entry) { return entry->error.empty(); }));
}

size_t Server::broken_count() const {
  return implementation_->index().list().size() - case_count();
}

void Server::run() { implementation_->run(); }

void Server::stop() { implementation_->stop(); }

}  // namespace clipgs
