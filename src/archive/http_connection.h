#pragma once

#include <chrono>
#include <exception>
#include <memory>
#include <optional>
#include <string>

#include "archive/http_client.h"

namespace clipgs {

/// Retry-After and growing waits end here.
inline constexpr std::chrono::milliseconds kLongestWait{60'000};

/// What is asked of a place.
struct OutgoingRequest {
  const char* method = "GET";
  std::string path;  ///< of the place, all of it
  std::string accept = "*/*";
  HttpBody body{};
};

/// Why a request got no answer, or not all of it.
enum class HttpFailure {
  kNone,
  kUnreachable,
  kConnectTimeout,
  kTls,
  kAuthorities,  ///< HttpOptions::authorities cannot be read
  kCertificate,  ///< the other end's
  kCut           ///< also where it does not go on
};

/// What a request came to.
struct HttpOutcome {
  HttpFailure failure = HttpFailure::kNone;
  int status = 0;  ///< 0: none
  std::string location;
  std::optional<std::chrono::milliseconds> retry_after;
  bool began = false;      ///< the receiver has something of it
  bool timed_out = false;  ///< nothing came within the limit
  bool through_proxy = false;
  long verification = 0;      ///< OpenSSL's X509_V_…, of the other end's certificate
  int alert = 0;              ///< of TLS, that came from the other end; 0: none
  std::exception_ptr thrown;  ///< by the receiver

  bool is_success() const { return failure == HttpFailure::kNone && status / 100 == 2; }
  bool is_redirect() const;
  /// Whether it may be otherwise another time.
  bool may_pass(const Url& url) const;
};

/// One connection that is kept, to one place, with what it may know of who asks. The only one who
/// knows cpp-httplib.
class HttpConnection {
 public:
  HttpConnection(Url place, const HttpOptions& options);
  ~HttpConnection();
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  const Url& url() const;
  /// The receiver gets nothing of an answer that is no success.
  HttpOutcome send(const OutgoingRequest& request, const HttpReceiver& receiver);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace clipgs
