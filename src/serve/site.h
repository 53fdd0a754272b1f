#pragma once

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/parser.hpp>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "asset/zip.h"
#include "serve/case_index.h"
#include "serve/throttle.h"

namespace clipgs {

using HttpRequest = boost::beast::http::request<boost::beast::http::empty_body>;
using HttpHead = boost::beast::http::response<boost::beast::http::empty_body>;

/// Of a request, its first line and its headers, in 16 KiB at most.
class RequestParser : public boost::beast::http::request_parser<boost::beast::http::empty_body> {
 public:
  static constexpr std::uint32_t kLimit = 16 << 10;
  RequestParser() { header_limit(kLimit); }
};

/// What a request is answered.
struct Answer {
  HttpHead head;
  ByteSource body;  ///< may be read from any thread
  /// Before it is sent: who tries what is wrong again and again has time.
  std::chrono::milliseconds delay{0};
  /// The connection ends with it.
  bool last = false;
};

/// First line and headers, as they are sent.
std::string head_text(const HttpHead& head);

struct SiteOptions {
  std::filesystem::path folder;  ///< its *.sog are the cases
  std::string token;             ///< only those who know it are answered; "": everyone is
  /// Where the server listens on a loopback address: what it is called there, beside the names
  /// that is_loopback() knows. Requests that call it anything else are refused.
  std::optional<std::string> local_name;
  std::string url;  ///< for those who are refused; without the token
};

/// What is served, without a network: requests in, answers out. Safe to use from several threads.
class Site {
 public:
  /// Throws Error if the folder is not there.
  explicit Site(SiteOptions options);

  /// `client`: who asks, see Throttle.
  Answer answer(const HttpRequest& request, const std::string& client);
  /// To what is no request.
  static Answer refuse(const boost::system::error_code& error);
  /// To the bytes that a client sent, up to the end of the first request in them: all that it is
  /// sent. "" if there is no end.
  std::string answer_bytes(std::string_view bytes);

  CaseIndex& index() { return index_; }

 private:
  bool is_called_rightly(const HttpRequest& request) const;
  /// Whether the request has the token. One that brings it in its address is sent on without it,
  /// all others are refused.
  bool may_enter(const HttpRequest& request, const std::string& path, const std::string& client,
                 Answer& answer);
  void give_of_case(const HttpRequest& request, std::string_view rest, bool versioned,
                    Answer& answer);

  SiteOptions options_;
  CaseIndex index_;
  Throttle throttle_;
};

}  // namespace clipgs
