#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "archive/url.h"

#include "core/error.h"

namespace clipgs {

class HttpConnection;
struct HttpOutcome;
struct OutgoingRequest;

/// Who asks an archive, and how long it is waited for. Secrets are in no error and no log.
struct HttpOptions {
  std::string token;                  ///< a bearer's; goes before user and password
  std::string user;                   ///< of basic authentication
  std::string password;               ///< likewise
  std::filesystem::path certificate;  ///< PEM, of the one who asks, those behind it as well
  std::filesystem::path key;          ///< PEM, of the certificate
  std::filesystem::path authorities;  ///< PEM: those to trust instead of the system's
  std::chrono::milliseconds connect_limit{10'000};
  std::chrono::milliseconds idle_limit{60'000};  ///< without an answer, or (almost) a byte of it
  int attempts = 4;                              ///< of what may be asked twice
  std::chrono::milliseconds first_wait{1'000};   ///< before the second one; then doubled each time
};

/// What an archive answers that is no success, or that it does not answer.
class HttpError : public Error {
 public:
  HttpError(int status_, const std::string& line) : Error("{}", line), status(status_) {}

  int status;  ///< 404, …; 0: there was no answer, or not all of it
};

/// The head of an answer, which is a success (2xx).
struct AnswerHead {
  int status = 200;
  std::string content_type;          ///< as the header says, "" without one
  std::uint64_t content_length = 0;  ///< bytes; 0: not said
};

/// An answer that is kept in memory.
struct HttpAnswer {
  AnswerHead head;
  std::string body;
};

/// A body that is sent.
struct HttpBody {
  std::string content_type;
  std::string bytes;
};

/// Takes an answer piece by piece. What is thrown ends the request, and is thrown by it.
struct HttpReceiver {
  std::function<void(const AnswerHead& head)> begin;  ///< once, before the first piece
  std::function<void(std::string_view bytes)> receive;
};

/// One archive, over one connection that is kept. Certificates are always verified; proxies are
/// those of the environment (proxy_for()). What may be asked twice (all but post) is, where the
/// archive cannot be reached or says 408, 429 or 5xx, with growing waits, or those that it asks for
/// (Retry-After, a minute at most). get() follows redirects, and tells no other place who asks.
/// Every request throws HttpError, in one line: what is wrong, with whom, and what to do. To be
/// used by one thread.
class HttpClient {
 public:
  /// `base`: goes before every path, e.g. "https://archive.example:8443/dicom-web". Throws Error,
  /// also for files of certificates that cannot be used.
  explicit HttpClient(const std::string& base, const HttpOptions& options = {});
  ~HttpClient();
  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;

  static constexpr std::uint64_t kMostAnswer = std::uint64_t{64} << 20U;  ///< bytes

  /// `path`: percent-encoded, "/studies?limit=10". `accept`: media types. At most `most` bytes.
  HttpAnswer get(const std::string& path, const std::string& accept,
                 std::uint64_t most = kMostAnswer);
  /// Asked twice only as long as nothing has begun.
  void get(const std::string& path, const std::string& accept, const HttpReceiver& receiver);
  HttpAnswer post(const std::string& path, const HttpBody& body, std::uint64_t most = kMostAnswer);
  HttpAnswer put(const std::string& path, const HttpBody& body, std::uint64_t most = kMostAnswer);
  HttpAnswer del(const std::string& path, std::uint64_t most = kMostAnswer);

  /// "archive.example:8443": what errors call it.
  std::string place() const;

 private:
  HttpOutcome ask(HttpConnection& connection, const OutgoingRequest& request,
                  const HttpReceiver& receiver) const;
  void send(OutgoingRequest request, const HttpReceiver& receiver);
  HttpAnswer answer_to(OutgoingRequest request, std::uint64_t most);

  Url base_;
  HttpOptions options_;
  std::unique_ptr<HttpConnection> connection_;
};

}  // namespace clipgs
