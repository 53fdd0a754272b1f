#include "serve/site.h"

#include <algorithm>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/write.hpp>
#include <fmt/format.h>
#include <sstream>
#include <utility>

#include "core/error.h"
#include "core/percent.h"
#include "serve/http.h"
#include "serve/request_kind.h"
#include "serve/viewer_bundle.h"

namespace clipgs {

namespace {

namespace http = boost::beast::http;
using http::field;
using http::status;

constexpr std::string_view kCasePrefix = "/cases/";
constexpr const char* kMetricsType = "text/plain; version=0.0.4; charset=utf-8";
constexpr const char* kAlwaysAsk = "no-cache";  // kept, but checked by its ETag before use
constexpr const char* kForEver = "public, max-age=31536000, immutable";

/// Isolation for SharedArrayBuffer, and nothing from elsewhere, nor for pages elsewhere: the page
/// works without the internet.
void set_common_headers(HttpHead& head) {
  head.set("Cross-Origin-Opener-Policy", "same-origin");
  head.set("Cross-Origin-Embedder-Policy", "require-corp");
  head.set("Cross-Origin-Resource-Policy", "same-origin");
  head.set("X-Content-Type-Options", "nosniff");
  head.set("Referrer-Policy", "no-referrer");
  head.set("Content-Security-Policy",
           "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self' "
           "'unsafe-inline'; img-src 'self' blob: data:; connect-src 'self' data:; "
           "object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'self'");
}

void give_viewer(const HttpRequest& request, Answer& answer, std::string_view path) {
  const auto files = viewer_files();
  if (files.empty()) {
    fail(answer, status::not_found,
         "this clipgs was built without its viewer; install nodejs, npm and clang-19 and build it "
         "again");
    return;
  }
  path = path == "/" ? "index.html" : path.substr(1);
  const auto file = std::ranges::find(files, path, &ViewerFile::path);
  if (file == files.end()) {
    fail(answer, status::not_found, "there is no such page; the viewer is at /");
    return;
  }
  std::vector<Encoding> offered;
  if (!file->brotli.empty()) {
    offered.push_back(Encoding::kBrotli);
  }
  if (!file->gzip.empty()) {
    offered.push_back(Encoding::kGzip);
  }
  const Encoding encoding = choose_encoding(header(request, field::accept_encoding), offered);
  const std::string_view bytes = encoding == Encoding::kBrotli ? file->brotli
                                 : encoding == Encoding::kGzip ? file->gzip
                                                               : file->bytes;
  // The names of assets hold a hash of their contents; a new program has a new index.html.
  const bool named_by_content = path.starts_with("assets/");
  answer.head.set(field::cache_control, named_by_content ? kForEver : kAlwaysAsk);
  if (!offered.empty()) {
    answer.head.set(field::vary, "Accept-Encoding");
  }
  if (not_modified(request, answer,
                   fmt::format("\"{}-{}\"", file->checksum, encoding_name(encoding)))) {
    return;
  }
  answer.head.set(field::content_type, content_type(path));
  if (encoding != Encoding::kIdentity) {
    answer.head.set(field::content_encoding, encoding_name(encoding));
  }
  answer.body = source_of(bytes);
}

}  // namespace

std::string head_text(const HttpHead& head) {
  std::ostringstream text;
  text << head.base();
  return text.str();
}

Site::Site(SiteOptions options)
    : options_(std::move(options)),
      cases_({options_.folder, options_.subfolders, options_.only, options_.live, options_.keeps,
              options_.audit}),
      overview_(options_.only.empty() ? options_.folder : std::filesystem::path()),
      entrance_(options_.token, options_.tokens),
      study_(options_.study.empty() ? nullptr : std::make_unique<StudyDesk>(options_.study)),
      log_(options_.access_log.empty() ? nullptr
                                       : std::make_unique<AccessLog>(options_.access_log)) {}

bool Site::wants_body(const HttpRequest& request) const {
  return (study_ != nullptr && StudyDesk::brings_records(request)) || cases_.is_brought(request);
}

Answer Site::answer(const HttpRequest& request, const Client& client) {
  Answer answer;
  answer.head.version(request.version());
  set_common_headers(answer.head);
  const std::string_view target = target_of(request);
  const std::string_view query = query_of(request);
  const std::optional<std::string> path =
      percent_decode(target.substr(0, target.size() - query.size()));
  try {
    if (!path || !path->starts_with('/')) {
      fail(answer, status::bad_request, "this is no address of this server; the viewer is at /");
    } else if (path == "/health") {
      give_health(answer);
    } else if (!is_called_rightly(request)) {
      fail(answer, status::forbidden, "open this server by its own address, " + options_.url);
    } else if (const auto grant = entrance_.admit(request, *path, client, answer)) {
      route({request, *path, query, client, *grant}, answer);
    }
  } catch (const Error& error) {
    fail(answer, status::service_unavailable, error.what());
  }
  if (answer.head.result() != status::not_modified) {
    answer.head.content_length(answer.body.size);
  }
  // Nobody reads another body, so what follows it is not found.
  const bool unread =
      !wants_body(request) && (request.chunked() || request.count(field::content_length) > 0);
  answer.last = answer.last || !request.keep_alive() || unread;
  answer.head.keep_alive(!answer.last);
  if (request.method() == http::verb::head) {
    answer.body = {};
  }
  return answer;
}

void Site::route(const Asked& asked, Answer& answer) {
  const HttpRequest& request = asked.request;
  const std::string& path = asked.path;
  const bool gives = request.method() == http::verb::get || request.method() == http::verb::head;
  if (!gives && !wants_body(request)) {
    answer.head.set(field::allow, "GET, HEAD");
    answer.last = true;  // a body may follow that nobody reads
    fail(answer, status::method_not_allowed, "this server only gives; use GET");
  } else if (path.starts_with(kCasePrefix)) {
    cases_.give_of_case(request, std::string_view(path).substr(kCasePrefix.size()),
                        asked.query.starts_with("?v="), asked.client, asked.grant, answer);
  } else if (OverviewDesk::is_asked(path)) {
    give_overview(asked, answer);
  } else if (path == "/api/cases") {
    cases_.give_list(asked.query, asked.grant, answer);
  } else if (path == "/metrics") {
    give_metrics(asked.grant, answer);
  } else if (StudyDesk::is_asked(path)) {
    give_study(asked, answer);
  } else {
    give_viewer(request, answer, path);
  }
}

void Site::give_overview(const Asked& asked, Answer& answer) {
  if (!asked.grant.sees_all()) {
    fail(answer, status::forbidden,
         "your address sees some folders alone, and the overview tells of all of them");
    return;
  }
  overview_.answer(asked.request, asked.path, answer);
}

void Site::give_study(const Asked& asked, Answer& answer) {
  const bool brings = asked.request.method() == http::verb::post;
  if (study_ == nullptr) {
    fail(answer, status::not_found,
         "this server records no study; start it with clipgs serve FOLDER --study FOLDER");
  } else if (!asked.grant.sees_all() || (brings && !asked.grant.writes)) {
    fail(answer, status::forbidden,
         "your address takes part in no study; ask for one that sees all cases and may write");
  } else {
    study_->answer(asked.request, asked.path, asked.query, answer);
  }
}

void Site::give_health(Answer& answer) {
  cases_.index().require_folder();
  if (!cases_.openings().is_well()) {
    throw Error("who opens cases cannot be recorded, so none is given");
  }
  give_text(answer, status::ok, "text/plain; charset=utf-8", "ok\n");
}

void Site::give_metrics(const Grant& grant, Answer& answer) {
  if (!grant.metrics) {
    fail(answer, status::forbidden,
         "metrics are for this machine itself, or for a token that may read them "
         "(clipgs token FILE --add NAME --metrics)");
    return;
  }
  give_text(answer, status::ok, kMetricsType,
            metrics_.text(cases_.count(), cases_.openings().count()));
}

void Site::record(const Exchange& exchange) {
  const std::string_view target = target_of(exchange.request);
  const auto path =
      percent_decode(target.substr(0, target.size() - query_of(exchange.request).size()));
  metrics_.answered(request_kind(path.value_or("")), exchange.answer.head.result_int(),
                    exchange.bytes);
  if (log_) {
    log_->write(exchange);
  }
}

void Site::reopen_logs() {
  const auto reopen = [](auto& log) {
    try {
      log.reopen();
    } catch (const Error& error) {
      warn(std::string(error.what()) + "; what was open goes on");
    }
  };
  if (log_) {
    reopen(*log_);
  }
  reopen(cases_.openings());
}

Answer Site::refuse(const boost::system::error_code& error) {
  Answer answer;
  set_common_headers(answer.head);
  const bool large = error == http::error::header_limit || error == http::error::buffer_overflow;
  if (large) {
    fail(answer, status::request_header_fields_too_large,
         "the request's headers are too large; delete cookies of other pages of this host");
  } else if (error == http::error::body_limit) {
    fail(answer, status::payload_too_large, "this is more than is recorded at once");
  } else {
    fail(answer, status::bad_request, "this is no request that a browser makes");
  }
  answer.head.content_length(answer.body.size);
  answer.last = true;
  answer.head.keep_alive(false);
  return answer;
}

std::string Site::answer_bytes(std::string_view bytes) {
  RequestParser parser;
  boost::system::error_code error;
  const size_t head_size = parser.put(boost::asio::buffer(bytes), error);
  if (!error && wants_body(parser.get()) && !parser.is_done()) {
    parser.eager(true);
    parser.put(boost::asio::buffer(bytes.substr(head_size)), error);
    if (!error && !parser.is_done()) {
      error = http::error::need_more;
    }
  }
  if (error == http::error::need_more) {
    return {};
  }
  const bool refused = error && (!parser.is_header_done() || wants_body(parser.get()));
  const Answer given = refused ? refuse(error) : answer(parser.get(), Client());
  const std::string text = head_text(given.head);
  std::string body(given.body.size, '\0');
  if (!body.empty()) {
    body.resize(given.body.read(0, {reinterpret_cast<std::uint8_t*>(body.data()), body.size()}));
  }
  return text + body;
}

bool Site::is_called_rightly(const HttpRequest& request) const {
  if (request.count(field::host) > 1) {
    return false;
  }
  const std::optional<std::string> name = host_name(header(request, field::host));
  return !options_.local_name || (name && (is_loopback(*name) || *name == options_.local_name ||
                                           *name == options_.public_name));
}

}  // namespace clipgs
