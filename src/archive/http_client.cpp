#include "archive/http_client.h"

#include <algorithm>
#include <charconv>
#include <csignal>
#include <exception>
#include <httplib.h>
#include <netdb.h>
#include <openssl/ssl.h>
#include <openssl/x509_vfy.h>
#include <optional>
#include <pthread.h>
#include <thread>

#include "archive/proxy.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr int kMostRedirects = 5;
constexpr milliseconds kLongestWait{60'000};
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

/// What a connection came to.
struct Outcome {
  httplib::Error error = httplib::Error::Success;
  int status = 0;  ///< 0: none
  std::string location;
  std::optional<milliseconds> retry_after;
  bool began = false;      ///< the receiver has something of it
  bool timed_out = false;  ///< no byte came within the limit
  long verification = X509_V_OK;
  int alert = 0;              ///< TLS alert that came from the other end; 0: none
  std::exception_ptr thrown;  ///< by the receiver
  bool through_proxy = false;

  bool is_success() const { return error == httplib::Error::Success && status / 100 == 2; }
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

/// Whether the system knows no such host, as far as that can be told.
bool is_unknown_host(const std::string& host) {
  addrinfo* found = nullptr;
  const int error = ::getaddrinfo(host.c_str(), nullptr, nullptr, &found);
  if (error == 0) {
    ::freeaddrinfo(found);
  }
  return error == EAI_NONAME;
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

std::string seconds_of(milliseconds time) {
  return fmt::format("{:.3g} s", std::chrono::duration<double>(time).count());
}

/// Why a certificate is not taken, and what to do.
std::string certificate_line(long verification) {
  switch (verification) {
    case X509_V_ERR_CERT_HAS_EXPIRED:
      return "the time of its certificate is over; ask those who run it to renew it";
    case X509_V_ERR_CERT_NOT_YET_VALID:
      return "its certificate is not good yet; is this machine's clock right?";
    case X509_V_OK:  // OpenSSL takes it, httplib does not find the host in it
    case X509_V_ERR_HOSTNAME_MISMATCH:
    case X509_V_ERR_IP_ADDRESS_MISMATCH:
      return "its certificate is for another host; give the name that the certificate has";
    case X509_V_ERR_DEPTH_ZERO_SELF_SIGNED_CERT:
    case X509_V_ERR_SELF_SIGNED_CERT_IN_CHAIN:
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT:
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT_LOCALLY:
    case X509_V_ERR_UNABLE_TO_VERIFY_LEAF_SIGNATURE:
      return "its certificate is not trusted; give the certificate of its authority with --ca-file";
    default:
      return fmt::format("its certificate is not trusted ({}); ask those who run it",
                         X509_verify_cert_error_string(verification));
  }
}

/// What the other end says of the certificate that it was shown, or not; "": nothing.
std::string alert_line(int alert, bool has_certificate) {
  switch (alert) {
    case SSL3_AD_HANDSHAKE_FAILURE:
    case SSL3_AD_BAD_CERTIFICATE:
    case SSL3_AD_CERTIFICATE_EXPIRED:
    case SSL3_AD_CERTIFICATE_REVOKED:
    case SSL3_AD_CERTIFICATE_UNKNOWN:
    case TLS1_AD_UNKNOWN_CA:
    case TLS1_AD_ACCESS_DENIED:
    case TLS13_AD_CERTIFICATE_REQUIRED:
      return has_certificate
                 ? "refuses the certificate of --client-certificate; give one that it knows"
                 : "wants a certificate of who asks; give --client-certificate and --client-key";
    default:
      return "";
  }
}

std::string connection_line(const Outcome& outcome, const Url& url, const HttpOptions& options) {
  const std::string alert = alert_line(outcome.alert, !options.certificate.empty());
  if (!alert.empty()) {
    return alert;
  }
  const char* const proxy = outcome.through_proxy ? ", or the proxy that leads there" : "";
  switch (outcome.error) {
    case httplib::Error::Connection:
      return outcome.through_proxy
                 ? "the proxy that leads there cannot be reached; check https_proxy"
             : is_unknown_host(url.host) ? "there is no host of that name; check the address"
                                         : "nobody answers there; check the address, its port, and "
                                           "whether the archive runs";
    case httplib::Error::ConnectionTimeout:
      return fmt::format("cannot be reached within {}; check the address and the network{}",
                         seconds_of(options.connect_limit), proxy);
    case httplib::Error::SSLConnection:
      return fmt::format("speaks no TLS that this program knows; is it http, not https{}?", proxy);
    case httplib::Error::SSLLoadingCerts:
      return fmt::format("{} holds no certificates of authorities; give a PEM file",
                         options.authorities.string());
    case httplib::Error::SSLServerVerification:
      return certificate_line(outcome.verification);
    default:
      return outcome.timed_out
                 ? fmt::format("does not go on within {}; try again later",
                               seconds_of(options.idle_limit))
                 : "the connection was cut; try again, and look whether the archive still runs";
  }
}

std::string status_line(int status, const HttpOptions& options) {
  const bool anonymous = options.token.empty() && options.user.empty();
  switch (status) {
    case 401:
      return anonymous ? "wants to know who asks (401); give --token-file, or --user"
                       : "does not take this token or password (401); get a new one";
    case 403:
      return "does not let you have that (403); ask those who run it for the right to";
    case 404:
      return "has nothing there (404); check the address, and the study's and series' UID";
    case 406:
      return "does not hand it out in this form (406); is it a DICOMweb archive?";
    case 407:
      return "the proxy wants to know who asks (407); give https_proxy a user and a password";
    case 429:
      return "is asked too often (429); try again later";
    default:
      return status >= 500
                 ? fmt::format("cannot do that now ({}); try again, and look at its log", status)
                 : fmt::format("answers {}, which is no success; check the address", status);
  }
}

bool may_pass(const Outcome& outcome, const Url& url) {
  if (outcome.thrown || outcome.began) {
    return false;
  }
  switch (outcome.error) {
    case httplib::Error::Success:
    case httplib::Error::Canceled:
      return outcome.status == 408 || outcome.status == 429 ||
             (outcome.status >= 500 && outcome.status != 501 && outcome.status != 505);
    case httplib::Error::Connection:
      return outcome.through_proxy || !is_unknown_host(url.host);
    case httplib::Error::ConnectionTimeout:
    case httplib::Error::Read:
    case httplib::Error::Write:
      return outcome.alert == 0;
    default:
      return false;
  }
}

}  // namespace

struct HttpClient::Request {
  const char* method = "GET";
  std::string path;
  std::string accept = "*/*";
  HttpBody body{};

  bool may_be_repeated() const { return std::string_view(method) != "POST"; }
};

/// To one place, with what it may know of who asks.
class HttpClient::Connection {
 public:
  Connection(Url place, const HttpOptions& options)
      : url_(std::move(place)), options_(options), proxy_(proxy_for(url_)) {
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

  Outcome send(const Request& request, const std::string& path, const HttpReceiver& receiver) {
    const NoPipeSignal quiet;
    Outcome outcome;
    outcome.through_proxy = proxy_.has_value();
    alert_ = 0;
    const httplib::Result result = client_->send(prepared(request, path, receiver, outcome));
    outcome.error = result.error();
    if (result) {  // of answers without a body, and a proxy's, nothing else tells
      take_head(*result, outcome);
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
      static_cast<Connection*>(SSL_CTX_get_app_data(SSL_get_SSL_CTX(ssl)))->alert_ = value & 0xff;
    }
  }

  static void take_head(const httplib::Response& response, Outcome& outcome) {
    outcome.status = response.status;
    outcome.location = response.get_header_value("Location");
    outcome.retry_after = retry_after(response);
  }

  httplib::Headers headers(const Request& request) const {
    httplib::Headers all{{"Accept", request.accept}, {"User-Agent", "clipgs"}};
    // Here, not by httplib, which would tell the proxy as well.
    if (!options_.token.empty()) {
      all.emplace("Authorization", "Bearer " + options_.token);
    } else if (!options_.user.empty()) {
      all.insert(httplib::make_basic_authentication_header(options_.user, options_.password));
    }
    if (proxy_ && url_.tls) {
      all.emplace("Proxy-Authorization",
                  "");  // else httplib tells the archive the proxy's password
    }
    if (!request.body.content_type.empty()) {
      all.emplace("Content-Type", request.body.content_type);
    }
    return all;
  }

  httplib::Request prepared(const Request& request, const std::string& path,
                            const HttpReceiver& receiver, Outcome& outcome) {
    httplib::Request sent;
    sent.method = request.method;
    sent.path = path;
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

  bool begin(const httplib::Response& response, const HttpReceiver& receiver, Outcome& outcome) {
    outcome.began = true;
    HttpHead head{response.status, response.get_header_value("Content-Type"), 0};
    const std::string length = response.get_header_value("Content-Length");
    std::from_chars(length.data(), length.data() + length.size(), head.content_length);
    return call(outcome, [&] { receiver.begin(head); });
  }

  /// What the receiver throws must not pass through httplib.
  template <typename Work>
  static bool call(Outcome& outcome, const Work& work) {
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

HttpClient::HttpClient(const std::string& base, const HttpOptions& options)
    : base_(parse_url(base)), options_(options) {
  if (options.certificate.empty() != options.key.empty()) {
    throw Error("--client-certificate and --client-key belong together; give both");
  }
  while (base_.path.ends_with('/')) {
    base_.path.pop_back();
  }
  connection_ = std::make_unique<Connection>(base_, options_);
}

HttpClient::~HttpClient() = default;

std::string HttpClient::place() const { return base_.place(); }

namespace {

bool is_redirect(int status) {
  return status == 301 || status == 302 || status == 303 || status == 307 || status == 308;
}

/// Without what only the archive itself may know.
HttpOptions anonymous(const HttpOptions& options) {
  HttpOptions others = options;
  others.token.clear();
  others.user.clear();
  others.password.clear();
  others.certificate.clear();
  others.key.clear();
  return others;
}

}  // namespace

void HttpClient::send(const Request& request, const HttpReceiver& receiver) {
  std::unique_ptr<Connection> elsewhere;
  std::string path = base_.path + request.path;
  milliseconds wait = options_.first_wait;
  int attempts = request.may_be_repeated() ? options_.attempts : 1;
  int redirects = 0;
  for (;;) {
    Connection& connection = elsewhere ? *elsewhere : *connection_;
    const Outcome outcome = connection.send(request, path, receiver);
    if (outcome.thrown) {
      std::rethrow_exception(outcome.thrown);
    }
    if (outcome.is_success()) {
      return;
    }
    if (is_redirect(outcome.status) && std::string_view(request.method) == "GET") {
      if (++redirects > kMostRedirects) {
        throw HttpError(outcome.status, fmt::format("{}: leads from one address to the next; check "
                                                    "the address",
                                                    connection.url().place()));
      }
      const Url next = redirected(connection.url(), outcome.location);
      if (connection.url().tls && !next.tls) {
        throw HttpError(
            outcome.status,
            fmt::format("{}: leads to an address that is not encrypted (http); give the "
                        "address that it has in the end",
                        connection.url().place()));
      }
      path = next.path;
      elsewhere = next.is_same_place(base_)
                      ? nullptr
                      : std::make_unique<Connection>(next, anonymous(options_));
      continue;
    }
    if (--attempts > 0 && may_pass(outcome, connection.url())) {
      std::this_thread::sleep_for(outcome.retry_after.value_or(wait));
      wait = std::min(2 * wait, kLongestWait);
      continue;
    }
    const bool has_status = outcome.status != 0 && outcome.status / 100 != 2;
    throw HttpError(has_status ? outcome.status : 0,
                    fmt::format("{}: {}", connection.url().place(),
                                has_status ? status_line(outcome.status, options_)
                                           : connection_line(outcome, connection.url(), options_)));
  }
}

HttpAnswer HttpClient::answer_to(const Request& request, std::uint64_t most) {
  HttpAnswer answer;
  send(request, {[&](const HttpHead& head) { answer = {head, {}}; },
                 [&](std::string_view bytes) {
                   if (bytes.size() > most - answer.body.size()) {
                     throw HttpError(0, fmt::format("{}: answers more than {} bytes; is it the "
                                                    "right address?",
                                                    place(), most));
                   }
                   answer.body += bytes;
                 }});
  return answer;
}

HttpAnswer HttpClient::get(const std::string& path, const std::string& accept, std::uint64_t most) {
  return answer_to({"GET", path, accept}, most);
}

void HttpClient::get(const std::string& path, const std::string& accept,
                     const HttpReceiver& receiver) {
  send({"GET", path, accept}, receiver);
}

HttpAnswer HttpClient::post(const std::string& path, const HttpBody& body, std::uint64_t most) {
  return answer_to({"POST", path, "*/*", body}, most);
}

HttpAnswer HttpClient::put(const std::string& path, const HttpBody& body, std::uint64_t most) {
  return answer_to({"PUT", path, "*/*", body}, most);
}

HttpAnswer HttpClient::del(const std::string& path, std::uint64_t most) {
  return answer_to({"DELETE", path}, most);
}

}  // namespace clipgs
