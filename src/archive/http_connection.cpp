#include "archive/http_connection.h"

#include <algorithm>
#include <charconv>
#include <csignal>
#include <httplib.h>
#include <openssl/ssl.h>
#include <pthread.h>

#include "archive/http_lines.h"
#include "archive/proxy.h"

namespace clipgs {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr std::uint64_t kLeastBytes = 1024;  // within the idle limit, or nothing goes on

/// OpenSSL writes to connections that may be closed at the other end, of which the signal would end
/// the program.
class NoPipeSignal {
 public:
  NoPipeSignal() {
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~NoPipeSignal() {
    const timespec now{};
    while (sigtimedwait(&pipe_, nullptr, &now) == SIGPIPE) {
    }
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  NoPipeSignal(const NoPipeSignal&) = delete;
  NoPipeSignal& operator=(const NoPipeSignal&) = delete;

 private:
  sigset_t pipe_{};
  sigset_t before_{};
};

/// Seconds; a date is passed over, as clocks differ.
std::optional<milliseconds> retry_after(const httplib::Response& response) {
  const std::string text = response.get_header_value("Retry-After");
  unsigned seconds = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, seconds);
  if (error != std::errc() || rest != end) {
    return std::nullopt;
  }
  return std::min(milliseconds(std::int64_t{1000} * seconds), kLongestWait);
}

/// A key with a password would have OpenSSL ask on the terminal.
int no_password(char* /*buffer*/, int /*size*/, int /*writing*/, void* /*data*/) { return -1; }

void use_client_certificate(SSL_CTX* context, const HttpOptions& options) {
  SSL_CTX_set_default_passwd_cb(context, no_password);
  if (SSL_CTX_use_certificate_chain_file(context, options.certificate.c_str()) != 1) {
    throw Error("{}: holds no certificate that can be read; give a PEM file, your own one first",
                options.certificate.string());
  }
  if (SSL_CTX_use_PrivateKey_file(context, options.key.c_str(), SSL_FILETYPE_PEM) != 1 ||
      SSL_CTX_check_private_key(context) != 1) {
    throw Error("{}: is not the key of {}, or has a password; give the PEM file that belongs to it",
                options.key.string(), options.certificate.string());
  }
}

/// So that a certificate of another host is told from one that is not trusted.
void expect_host(SSL_CTX* context, const std::string& host) {
  X509_VERIFY_PARAM* const expected = SSL_CTX_get0_param(context);
  if (X509_VERIFY_PARAM_set1_ip_asc(expected, host.c_str()) != 1) {
    X509_VERIFY_PARAM_set1_host(expected, host.data(), host.size());
  }
}

HttpFailure failure_of(httplib::Error error) {
  switch (error) {
    case httplib::Error::Success:
      return HttpFailure::kNone;
    case httplib::Error::Connection:
      return HttpFailure::kUnreachable;
    case httplib::Error::ConnectionTimeout:
      return HttpFailure::kConnectTimeout;
    case httplib::Error::SSLConnection:
      return HttpFailure::kTls;
    case httplib::Error::SSLLoadingCerts:
      return HttpFailure::kAuthorities;
    case httplib::Error::SSLServerVerification:
      return HttpFailure::kCertificate;
    default:
      return HttpFailure::kCut;
  }
}

}  // namespace

bool HttpOutcome::is_redirect() const {
  return status == 301 || status == 302 || status == 303 || status == 307 || status == 308;
}

bool HttpOutcome::may_pass(const Url& url) const {
  if (thrown || began) {
    return false;
  }
  if (status != 0) {
    return status == 408 || status == 429 || (status >= 500 && status != 501 && status != 505);
  }
  switch (failure) {
    case HttpFailure::kUnreachable:
      return through_proxy || !is_unknown_host(url.host);
    case HttpFailure::kConnectTimeout:
      return true;
    case HttpFailure::kCut:
      return alert == 0;
    default:
      return false;
  }
}

class HttpConnection::Implementation {
 public:
  Implementation(Url place, HttpOptions options)
      : url_(std::move(place)), options_(std::move(options)), proxy_(proxy_for(url_)) {
    if (url_.tls) {
      auto tls = std::make_unique<httplib::SSLClient>(url_.host, url_.port);
      tls_ = tls.get();
      client_ = std::move(tls);
      prepare_tls();
    } else {
      client_ = std::make_unique<httplib::ClientImpl>(url_.host, url_.port);
    }
    client_->set_keep_alive(true);
    client_->set_tcp_nodelay(true);
    client_->set_url_encode(false);
    client_->set_connection_timeout(options_.connect_limit);
    client_->set_read_timeout(options_.idle_limit);
    client_->set_write_timeout(options_.idle_limit);
    if (proxy_) {
      client_->set_proxy(proxy_->host, proxy_->port);
      client_->set_proxy_basic_auth(proxy_->user, proxy_->password);
    }
  }

  const Url& url() const { return url_; }

  HttpOutcome send(const OutgoingRequest& request, const HttpReceiver& receiver) {
    const NoPipeSignal quiet;
    HttpOutcome outcome;
    outcome.through_proxy = proxy_.has_value();
    alert_ = 0;
    const httplib::Result result = client_->send(prepared(request, receiver, outcome));
    outcome.failure = failure_of(result.error());
    if (result) {  // of answers without a body, and a proxy's, nothing else tells
      take_head(*result, outcome);
      if (outcome.is_success() && !outcome.began) {
        begin(*result, receiver, outcome);
      }
    }
    outcome.timed_out = Clock::now() - last_ >= options_.idle_limit;
    outcome.alert = alert_;
    if (tls_ != nullptr) {
      outcome.verification = tls_->get_openssl_verify_result();
    }
    return outcome;
  }

 private:
  void prepare_tls() {
    SSL_CTX* const context = tls_->ssl_context();
    SSL_CTX_set_min_proto_version(context, TLS1_2_VERSION);
    SSL_CTX_set_app_data(context, this);
    SSL_CTX_set_info_callback(context, note_alert);
    expect_host(context, url_.host);
    if (!options_.certificate.empty()) {
      use_client_certificate(context, options_);
    }
    if (!options_.authorities.empty()) {
      tls_->set_ca_cert_path(options_.authorities.string());
    }
  }

  static void note_alert(const SSL* ssl, int where, int value) {
    if ((where & SSL_CB_READ_ALERT) == SSL_CB_READ_ALERT) {
      static_cast<Implementation*>(SSL_CTX_get_app_data(SSL_get_SSL_CTX(ssl)))->alert_ =
          value & 0xff;
    }
  }

  static void take_head(const httplib::Response& response, HttpOutcome& outcome) {
    outcome.status = response.status;
    outcome.location = response.get_header_value("Location");
    outcome.retry_after = retry_after(response);
  }

  httplib::Headers headers(const OutgoingRequest& request) const {
    httplib::Headers all{{"Accept", request.accept}, {"User-Agent", "clipgs"}};
    // Here, not by httplib, which would tell the proxy as well.
    if (!options_.token.empty()) {
      all.emplace("Authorization", "Bearer " + options_.token);
    } else if (!options_.user.empty()) {
      all.insert(httplib::make_basic_authentication_header(options_.user, options_.password));
    }
    // Else httplib tells the archive the proxy's password.
    if (proxy_ && url_.tls && !proxy_->user.empty()) {
      all.emplace("Proxy-Authorization", "");
    }
    if (!request.body.content_type.empty()) {
      all.emplace("Content-Type", request.body.content_type);
    }
    return all;
  }

  httplib::Request prepared(const OutgoingRequest& request, const HttpReceiver& receiver,
                            HttpOutcome& outcome) {
    httplib::Request sent;
    sent.method = request.method;
    sent.path = request.path;
    sent.headers = headers(request);
    sent.body = request.body.bytes;
    last_ = Clock::now();
    sent.response_handler = [this, &receiver, &outcome](const httplib::Response& response) {
      last_ = Clock::now();
      bytes_ = 0;
      take_head(response, outcome);
      return response.status / 100 == 2 && begin(response, receiver, outcome);
    };
    sent.content_receiver = [this, &receiver, &outcome](const char* data, size_t size,
                                                        std::uint64_t, std::uint64_t) {
      return goes_on(size) && call(outcome, [&] { receiver.receive({data, size}); });
    };
    return sent;
  }

  static bool begin(const httplib::Response& response, const HttpReceiver& receiver,
                    HttpOutcome& outcome) {
    outcome.began = true;
    AnswerHead head{response.status, response.get_header_value("Content-Type"), 0};
    const std::string length = response.get_header_value("Content-Length");
    std::from_chars(length.data(), length.data() + length.size(), head.content_length);
    return call(outcome, [&] { receiver.begin(head); });
  }

  /// What the receiver throws must not pass through httplib.
  template <typename Work>
  static bool call(HttpOutcome& outcome, const Work& work) {
    try {
      work();
    } catch (...) {
      outcome.thrown = std::current_exception();
      return false;
    }
    return true;
  }

  /// False where bytes only drip.
  bool goes_on(size_t size) {
    bytes_ += size;
    const Clock::time_point now = Clock::now();
    if (bytes_ >= kLeastBytes) {
      bytes_ = 0;
      last_ = now;
    }
    return now - last_ < options_.idle_limit;
  }

  Url url_;
  HttpOptions options_;
  std::optional<Proxy> proxy_;
  std::unique_ptr<httplib::ClientImpl> client_;
  httplib::SSLClient* tls_ = nullptr;  ///< the client, if it is one
  Clock::time_point last_;             ///< when something came
  std::uint64_t bytes_ = 0;            ///< since then
  int alert_ = 0;
};

HttpConnection::HttpConnection(Url place, const HttpOptions& options)
    : implementation_(std::make_unique<Implementation>(std::move(place), options)) {}

HttpConnection::~HttpConnection() {
  const NoPipeSignal quiet;  // it says goodbye
  implementation_.reset();
}

const Url& HttpConnection::url() const { return implementation_->url(); }

HttpOutcome HttpConnection::send(const OutgoingRequest& request, const HttpReceiver& receiver) {
  return implementation_->send(request, receiver);
}

}  // namespace clipgs
