#include "serve/marks_desk.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "core/digest.h"
#include "core/error.h"
#include "core/file.h"
#include "serve/http.h"

namespace clipgs {

namespace {

namespace http = boost::beast::http;
using http::field;
using http::status;

constexpr std::string_view kCases = "/cases/";
constexpr std::string_view kSuffix = ".marks.json";
constexpr const char* kJson = "application/json";
// As kMostMarks of web/src/model/marks.ts.
constexpr size_t kMostMarks = 500;
constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 20;

/// Nothing where there is no file. Links are not followed: they could lead out of the folder.
std::optional<std::string> read_marks(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status state = std::filesystem::symlink_status(file, error);
  if (!std::filesystem::exists(state)) {
    return std::nullopt;
  }
  if (!std::filesystem::is_regular_file(state)) {
    throw Error("{}: marks are kept in a file of their own; this is none",
                file.filename().string());
  }
  const std::vector<std::uint8_t> bytes = read_file(file, kMostBytes);
  return std::string(bytes.begin(), bytes.end());
}

std::string etag_of(const std::string& text) {
  return '"' + Digest().add(text).hex().substr(0, 32) + '"';
}

/// What a file of marks is, as far as it matters here: viewers check what they show of it.
std::string problem_of(const std::string& text) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  const bool is_file = json.is_object() && json.value("clipgs_marks", nlohmann::json()) == 1 &&
                       json.contains("marks") && json["marks"].is_array();
  if (!is_file) {
    return "this is no file of marks of version 1";
  }
  if (json["marks"].size() > kMostMarks) {
    return fmt::format("{} marks are more than the {} that are kept", json["marks"].size(),
                       kMostMarks);
  }
  return "";
}

}  // namespace

MarksDesk::MarksDesk(std::filesystem::path folder, bool keeps)
    : folder_(std::move(folder)), keeps_(keeps) {}

std::string_view MarksDesk::case_of(std::string_view rest) {
  return rest.ends_with(kSuffix) ? rest.substr(0, rest.size() - kSuffix.size())
                                 : std::string_view();
}

bool MarksDesk::brings_marks(const HttpRequest& request) {
  const std::string_view target = target_of(request);
  return request.method() == http::verb::put && target.starts_with(kCases) &&
         target.ends_with(kSuffix);
}

void MarksDesk::answer(const HttpRequest& request, const std::string& name, Answer& answer) {
  const std::filesystem::path file = folder_ / (name + std::string(kSuffix));
  if (request.method() == http::verb::put) {
    take(request, file, answer);
  } else {
    give(request, file, answer);
  }
}

void MarksDesk::give(const HttpRequest& request, const std::filesystem::path& file,
                     Answer& answer) const {
  std::optional<std::string> text = read_marks(file);
  if (!text) {
    // No failure: most cases have none.
    answer.head.result(status::no_content);
    answer.head.set(field::cache_control, "no-cache");
    return;
  }
  const std::string etag = etag_of(*text);
  if (etag_matches(header(request, field::if_none_match), etag)) {
    answer.head.set(field::etag, etag);
    answer.head.result(status::not_modified);
    return;
  }
  give_text(answer, status::ok, kJson, std::move(*text));
  answer.head.set(field::etag, etag);
}

void MarksDesk::take(const HttpRequest& request, const std::filesystem::path& file,
                     Answer& answer) {
  if (!keeps_) {
    fail(answer, status::forbidden,
         "this server keeps no marks; start it with clipgs serve FOLDER --keep-marks");
    return;
  }
  if (!is_from_own_page(request, kJson)) {
    fail(answer, status::forbidden, "marks come from this server's own pages alone");
    return;
  }
  if (const std::string problem = problem_of(request.body()); !problem.empty()) {
    fail(answer, status::unprocessable_entity, problem);
    return;
  }
  const std::scoped_lock lock(writing_);
  const std::optional<std::string> before = read_marks(file);
  const std::string_view wanted = header(request, field::if_match);
  const bool is_new = header(request, field::if_none_match) == "*";
  const bool is_known = before ? wanted == etag_of(*before) : is_new;
  if (!is_known) {
    fail(answer, status::precondition_failed, "somebody else changed these marks; read them again");
    return;
  }
  try {
    write_file(file, request.body().data(), request.body().size());
  } catch (const Error& error) {
    fail(answer, status::insufficient_storage, error.what());
    return;
  }
  answer.head.result(status::no_content);
  answer.head.set(field::etag, etag_of(request.body()));
}

}  // namespace clipgs
