#include "serve/access_log.h"

#include <algorithm>
#include <boost/beast/http/field.hpp>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/percent.h"
#include "core/utf8.h"
#include "serve/http.h"
#include "serve/request_kind.h"

namespace clipgs {

namespace {

using boost::beast::http::field;

constexpr size_t kMostAgent = 200;

/// The path that is asked for, where it may be told; it is short: there is such a thing.
std::string told_path(RequestKind kind, const std::string& path) {
  return kind == RequestKind::kOther || kind == RequestKind::kStudy ? "" : path;
}

/// What is no method is anything at all.
std::string method_of(const HttpRequest& request) {
  return request.method() == boost::beast::http::verb::unknown
             ? ""
             : std::string(request.method_string());
}

}  // namespace

std::string access_line(const Exchange& exchange, std::chrono::system_clock::time_point now) {
  const HttpRequest& request = exchange.request;
  const std::string_view target = target_of(request);
  const std::string path =
      percent_decode(target.substr(0, std::min(target.find('?'), target.size()))).value_or("");
  const RequestKind kind = request_kind(path);
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(exchange.took);
  nlohmann::ordered_json line = {{"time", log_time(now)},
                                 {"client", exchange.client.address},
                                 {"token", exchange.answer.token},
                                 {"method", method_of(request)},
                                 {"kind", kind_name(kind)},
                                 {"path", told_path(kind, path)},
                                 {"status", exchange.answer.head.result_int()},
                                 {"bytes", exchange.bytes},
                                 {"ms", ms.count()}};
  const std::string agent(header(request, field::user_agent));
  line["agent"] = utf8_beginning(agent, kMostAgent);
  // ASCII alone: whatever a client writes stays within its string, and its line.
  return line.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

void AccessLog::write(const Exchange& exchange) {
  try {
    file_.write(access_line(exchange, std::chrono::system_clock::now()));
    failed_ = false;
  } catch (const Error& error) {
    if (!failed_.exchange(true)) {
      warn(error.what());
    }
  }
}

}  // namespace clipgs
