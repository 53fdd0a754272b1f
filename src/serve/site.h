#pragma once

#include <boost/beast/http/parser.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "serve/access_log.h"
#include "serve/answer.h"
#include "serve/case_desk.h"
#include "serve/client.h"
#include "serve/companion_desk.h"
#include "serve/entrance.h"
#include "serve/live_work.h"
#include "serve/metrics.h"
#include "serve/overview_desk.h"
#include "serve/study_desk.h"

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

/// What a site consists of, and who may see it.
struct SiteOptions {
  std::filesystem::path folder;  ///< its *.sog are the cases
  std::string token;             ///< see Entrance
  /// Where the server listens on a loopback address: what it is called there, beside the names
  /// that is_loopback() knows. Requests that call it anything else are refused.
  std::optional<std::string> local_name;
  std::string url;                        ///< for those who are refused; without the token
  std::filesystem::path study = {};       ///< where a study is recorded; "": nowhere
  std::set<std::string> only = {};        ///< see CaseIndex
  LiveWork* live = nullptr;               ///< what is made meanwhile; outlives the site
  CompanionDesk::Keeps keeps = {};        ///< what beside cases may be changed
  bool subfolders = false;                ///< see CaseIndex
  std::filesystem::path tokens = {};      ///< see Entrance
  std::filesystem::path access_log = {};  ///< see AccessLog; "": none
  std::filesystem::path audit = {};       ///< see CaseOpenings
  std::string public_name = {};           ///< what else it may be called; "": nothing
};

/// What is served, without a network: requests in, answers out. Safe to use from several threads.
class Site {
 public:
  /// Throws Error if the folder is not there, or another program records a study in that of one.
  explicit Site(SiteOptions options);

  /// Whether a request has a body that is to be read before it is answered.
  bool wants_body(const HttpRequest& request) const;
  Answer answer(const HttpRequest& request, const Client& client);
  /// What came of a request, or of what was none.
  void record(const Exchange& exchange);
  /// To what is no request.
  static Answer refuse(const boost::system::error_code& error);
  /// To the bytes that a client sent, up to the end of the first request in them: all that it is
  /// sent. "" if there is no end.
  std::string answer_bytes(std::string_view bytes);

  CaseDesk& cases() { return cases_; }
  Metrics& metrics() { return metrics_; }
  /// Goes on in new files where those that were written were renamed.
  void reopen_logs();

 private:
  /// A request of somebody who is let in.
  struct Asked {
    const HttpRequest& request;
    const std::string& path;
    std::string_view query;
    const Client& client;
    const Grant& grant;
  };

  void route(const Asked& asked, Answer& answer);
  bool is_called_rightly(const HttpRequest& request) const;
  /// To who sees all cases.
  void give_overview(const Asked& asked, Answer& answer);
  void give_study(const Asked& asked, Answer& answer);
  /// Says to anybody whether cases can be given, and nothing else.
  void give_health(Answer& answer);
  void give_metrics(const Grant& grant, Answer& answer);

  SiteOptions options_;
  CaseDesk cases_;
  OverviewDesk overview_;
  Entrance entrance_;
  Metrics metrics_;
  std::unique_ptr<StudyDesk> study_;
  std::unique_ptr<AccessLog> log_;
};

}  // namespace clipgs
