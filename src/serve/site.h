#pragma once

#include <boost/beast/http/parser.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "serve/answer.h"
#include "serve/case_index.h"
#include "serve/companion_desk.h"
#include "serve/live_work.h"
#include "serve/overview_desk.h"
#include "serve/study_desk.h"
#include "serve/throttle.h"

namespace clipgs {

/// Of a request, its first line and its headers, in 16 KiB at most, and the body of one that brings
/// records of a study, marks or a tour, in 256 KiB.
class RequestParser : public boost::beast::http::request_parser<boost::beast::http::string_body> {
 public:
  static constexpr std::uint32_t kLimit = 16 << 10;
  static constexpr std::uint64_t kBodyLimit = 256 << 10;
  RequestParser() {
    header_limit(kLimit);
    body_limit(kBodyLimit);
  }
};

/// First line and headers, as they are sent.
std::string head_text(const HttpHead& head);

struct SiteOptions {
  std::filesystem::path folder;  ///< its *.sog are the cases
  std::string token;             ///< only those who know it are answered; "": everyone is
  /// Where the server listens on a loopback address: what it is called there, beside the names
  /// that is_loopback() knows. Requests that call it anything else are refused.
  std::optional<std::string> local_name;
  std::string url;                   ///< for those who are refused; without the token
  std::filesystem::path study = {};  ///< where a study is recorded; "": nowhere
  std::set<std::string> only = {};   ///< see CaseIndex
  LiveWork* live = nullptr;          ///< what is made meanwhile; outlives the site
  CompanionDesk::Keeps keeps = {};   ///< what beside cases may be changed
};

/// What is served, without a network: requests in, answers out. Safe to use from several threads.
class Site {
 public:
  /// Throws Error if the folder is not there, or another program records a study in that of one.
  explicit Site(SiteOptions options);

  /// Whether a request has a body that is to be read before it is answered.
  bool wants_body(const HttpRequest& request) const;
  /// `client`: who asks, see Throttle.
  Answer answer(const HttpRequest& request, const std::string& client);
  /// To what is no request.
  static Answer refuse(const boost::system::error_code& error);
  /// To the bytes that a client sent, up to the end of the first request in them: all that it is
  /// sent. "" if there is no end.
  std::string answer_bytes(std::string_view bytes);

  CaseIndex& index() { return index_; }

 private:
  void route(const HttpRequest& request, const std::string& path, std::string_view query,
             Answer& answer);
  bool is_called_rightly(const HttpRequest& request) const;
  /// Whether the request has the token. One that brings it in its address is sent on without it,
  /// all others are refused.
  bool may_enter(const HttpRequest& request, const std::string& path, const std::string& client,
                 Answer& answer);
  void give_cases(std::string_view query, Answer& answer);
  void give_of_case(const HttpRequest& request, std::string_view rest, bool versioned,
                    Answer& answer);

  SiteOptions options_;
  CaseIndex index_;
  Throttle throttle_;
  CompanionDesk companions_;
  OverviewDesk overview_;
  std::unique_ptr<StudyDesk> study_;
};

}  // namespace clipgs
