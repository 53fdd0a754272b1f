#include "serve/site.h"

#include <algorithm>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/write.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <openssl/crypto.h>
#include <sstream>
#include <utility>

#include "core/error.h"
#include "serve/certificate.h"
#include "serve/http.h"
#include "serve/viewer_bundle.h"

namespace clipgs {

namespace {

namespace http = boost::beast::http;
using http::field;
using http::status;

constexpr std::string_view kCookie = "__Host-clipgs";
constexpr std::string_view kCasePrefix = "/cases/";
constexpr std::string_view kCaseSuffix = ".sog";
constexpr std::string_view kThumbnailSuffix = "/thumbnail";
// What a page calls itself when it asks what cases there are, and how it says that it is closed.
constexpr std::string_view kPage = "?page=";
constexpr std::string_view kLeft = "&left";
constexpr const char* kAlwaysAsk = "no-cache";  // kept, but checked by its ETag before use
constexpr const char* kForEver = "public, max-age=31536000, immutable";
constexpr std::chrono::milliseconds kDelay(2000);

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

/// Whether the browser already has what `etag` names; then it is told so.
bool not_modified(const HttpRequest& request, Answer& answer, const std::string& etag) {
  answer.head.set(field::etag, etag);
  if (!etag_matches(header(request, field::if_none_match), etag)) {
    return false;
  }
  answer.head.result(status::not_modified);
  return true;
}

void give_case(const HttpRequest& request, Answer& answer, const CaseEntry& entry,
               const std::shared_ptr<const OpenFile>& file) {
  const FileState& state = file->state();
  const std::string etag = '"' + state.version + '"';
  answer.head.set(field::cache_control, kAlwaysAsk);
  answer.head.set(field::accept_ranges, "bytes");
  if (not_modified(request, answer, etag)) {
    return;
  }
  std::uint64_t first = 0;
  std::uint64_t size = state.size;
  // If-Range: a range of another version is of no use, so the whole file is given.
  const std::string_view version = header(request, field::if_range);
  const std::vector<ByteRange> ranges = parse_ranges(header(request, field::range));
  if (!ranges.empty() && (version.empty() || version == etag)) {
    const std::optional<ByteRange> range = satisfiable_range(ranges, state.size);
    if (!range) {
      answer.head.set(field::content_range, fmt::format("bytes */{}", state.size));
      fail(answer, status::range_not_satisfiable, entry.name + ".sog: has no such range of bytes");
      return;
    }
    first = static_cast<std::uint64_t>(range->first);
    size = static_cast<std::uint64_t>(range->second - range->first + 1);
    answer.head.result(status::partial_content);
    answer.head.set(field::content_range,
                    fmt::format("bytes {}-{}/{}", range->first, range->second, state.size));
  }
  answer.head.set(field::content_type, "application/octet-stream");
  answer.body = {size, [file, first](std::uint64_t offset, std::span<std::uint8_t> out) {
                   return file->read(first + offset, out);
                 }};
}

void give_thumbnail(const HttpRequest& request, Answer& answer,
                    const std::shared_ptr<const CaseEntry>& entry, bool versioned) {
  const Bytes& bytes = entry->info.thumbnail;
  if (bytes.empty()) {
    fail(answer, status::not_found, entry->name + ".sog: has no thumbnail");
    return;
  }
  answer.head.set(field::cache_control, versioned ? kForEver : kAlwaysAsk);
  if (!not_modified(request, answer, "\"t" + entry->version + '"')) {
    answer.head.set(field::content_type, "image/webp");
    answer.body = source_of({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, entry);
  }
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

bool is_secret(std::string_view given, std::string_view secret) {
  return given.size() == secret.size() &&
         CRYPTO_memcmp(given.data(), secret.data(), secret.size()) == 0;
}

/// Whether a page may have been meant as the secret part of an address: what else is asked for by
/// those who lack it has a dot or a stroke.
bool may_be_token(std::string_view page) {
  return !page.empty() && page.find_first_of("./") == std::string_view::npos;
}

}  // namespace

std::string head_text(const HttpHead& head) {
  std::ostringstream text;
  text << head.base();
  return text.str();
}

Site::Site(SiteOptions options)
    : options_(std::move(options)),
      index_(options_.folder, options_.only),
      companions_(options_.folder, options_.keeps),
      overview_(options_.only.empty() ? options_.folder : std::filesystem::path()),
      study_(options_.study.empty() ? nullptr : std::make_unique<StudyDesk>(options_.study)) {}

bool Site::wants_body(const HttpRequest& request) const {
  return (study_ != nullptr && StudyDesk::brings_records(request)) ||
         companions_.is_brought(request);
}

Answer Site::answer(const HttpRequest& request, const std::string& client) {
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
    } else if (!is_called_rightly(request)) {
      fail(answer, status::forbidden, "open this server by its own address, " + options_.url);
    } else if (!options_.token.empty() && !may_enter(request, *path, client, answer)) {
      // answered
    } else {
      route(request, *path, query, answer);
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

void Site::route(const HttpRequest& request, const std::string& path, std::string_view query,
                 Answer& answer) {
  const bool gives = request.method() == http::verb::get || request.method() == http::verb::head;
  if (!gives && !wants_body(request)) {
    answer.head.set(field::allow, "GET, HEAD");
    answer.last = true;  // a body may follow that nobody reads
    fail(answer, status::method_not_allowed, "this server only gives; use GET");
  } else if (path.starts_with(kCasePrefix)) {
    give_of_case(request, std::string_view(path).substr(kCasePrefix.size()),
                 query.starts_with("?v="), answer);
  } else if (OverviewDesk::is_asked(path)) {
    overview_.answer(request, path, answer);
  } else if (path == "/api/cases") {
    give_cases(query, answer);
  } else if (!StudyDesk::is_asked(path)) {
    give_viewer(request, answer, path);
  } else if (study_ != nullptr) {
    study_->answer(request, path, query, answer);
  } else {
    fail(answer, status::not_found,
         "this server records no study; start it with clipgs serve FOLDER --study FOLDER");
  }
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
  const Answer given = refused ? refuse(error) : answer(parser.get(), {});
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
  return !options_.local_name || (name && (is_loopback(*name) || *name == options_.local_name));
}

bool Site::may_enter(const HttpRequest& request, const std::string& path, const std::string& client,
                     Answer& answer) {
  const std::string_view kept = cookie(header(request, field::cookie), kCookie);
  const std::string page = path.substr(1);
  if (is_secret(kept, options_.token)) {
    return true;
  }
  if (is_secret(plain_token(page), plain_token(options_.token))) {
    answer.head.result(status::found);
    answer.head.set(field::location, "/" + std::string(query_of(request)));
    answer.head.set(field::cache_control, "no-store");
    // Lax, so that a link to a view can be followed from another site: nothing is changed by GET,
    // and what other sites embed or fetch still comes without the cookie.
    answer.head.set(field::set_cookie,
                    fmt::format("{}={}; Path=/; Secure; HttpOnly; SameSite=Lax; Max-Age=31536000",
                                kCookie, options_.token));
    return false;
  }
  const bool tried = !kept.empty() || may_be_token(page);
  if (tried && throttle_.is_one_too_many(client)) {
    answer.delay = kDelay;
    answer.last = true;
    answer.head.set(field::retry_after, "6");
    fail(answer, status::too_many_requests, "too many wrong addresses; wait a little");
  } else {
    fail(answer, status::forbidden,
         "open the whole address that clipgs serve printed, with the letters at its end");
  }
  return false;
}

void Site::give_cases(std::string_view query, Answer& answer) {
  nlohmann::json json = case_index_json(index_.list());
  json["keeps_marks"] = companions_.keeps().marks;
  json["keeps_tours"] = companions_.keeps().tours;
  if (options_.live != nullptr) {
    json["making"] = options_.live->json();
    if (query.starts_with(kPage)) {
      std::string page(query.substr(kPage.size()));
      if (page.ends_with(kLeft)) {
        page.resize(page.size() - kLeft.size());
        options_.live->page_left(page);
      } else {
        options_.live->page_seen(page);
      }
    }
  }
  give_text(answer, status::ok, "application/json",
            json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

void Site::give_of_case(const HttpRequest& request, std::string_view rest, bool versioned,
                        Answer& answer) {
  if (const std::optional wanted = CompanionDesk::wanted_of(rest)) {
    if (index_.find(std::string(wanted->name)) == nullptr) {
      fail(answer, status::not_found, "there is no such case; choose another from the menu");
    } else {
      companions_.answer(request, *wanted, answer);
    }
    return;
  }
  const bool thumbnail = rest.ends_with(kThumbnailSuffix);
  const std::string_view suffix = thumbnail ? kThumbnailSuffix : kCaseSuffix;
  const std::string name(rest.substr(0, rest.size() - std::min(suffix.size(), rest.size())));
  const auto entry = rest.ends_with(suffix) ? index_.find(name) : nullptr;
  if (entry == nullptr) {
    fail(answer, status::not_found, "there is no such case; choose another from the menu");
  } else if (!entry->error.empty()) {
    fail(answer, status::unprocessable_entity, entry->error);
  } else if (thumbnail) {
    give_thumbnail(request, answer, entry, versioned);
  } else {
    give_case(request, answer, *entry, index_.open(*entry));
  }
}

}  // namespace clipgs
