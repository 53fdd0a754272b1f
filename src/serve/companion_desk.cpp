#include "serve/companion_desk.h"

#include <algorithm>
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
constexpr const char* kJson = "application/json";

/// What a kind is called, and what its files hold: keys and limits of web/src/model/marks_file.ts
/// and tour.ts.
struct FileOfKind {
  CompanionDesk::Kind kind;
  std::string_view suffix;
  const char* noun;
  const char* option;  ///< of clipgs serve
  const char* version_key;
  const char* list_key;
  size_t most;
};

constexpr std::array<FileOfKind, 2> kFiles{{
    {CompanionDesk::Kind::kMarks, ".marks.json", "marks", "--keep-marks", "clipgs_marks", "marks",
     500},
    {CompanionDesk::Kind::kTour, ".tour.json", "tours", "--keep-tours", "clipgs_tour", "stops",
     100},
}};

const FileOfKind& file_of(CompanionDesk::Kind kind) {
  return *std::ranges::find(kFiles, kind, &FileOfKind::kind);
}

constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 20;

/// Nothing where there is no file. Links are not followed: they could lead out of the folder.
std::optional<std::string> read_companion(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status state = std::filesystem::symlink_status(file, error);
  if (!std::filesystem::exists(state)) {
    return std::nullopt;
  }
  if (!std::filesystem::is_regular_file(state)) {
    throw Error("{}: this is no file of its own, as it has to be", file.filename().string());
  }
  const std::vector<std::uint8_t> bytes = read_file(file, kMostBytes);
  return std::string(bytes.begin(), bytes.end());
}

std::string etag_of(const std::string& text) {
  return '"' + Digest().add(text).hex().substr(0, 32) + '"';
}

/// What a file is, as far as it matters here: viewers check what they show of it.
std::string problem_of(const std::string& text, const FileOfKind& kind) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  const bool is_file = json.is_object() && json.value(kind.version_key, nlohmann::json()) == 1 &&
                       json.contains(kind.list_key) && json[kind.list_key].is_array();
  if (!is_file) {
    return fmt::format("this is no file of {} of version 1", kind.noun);
  }
  const size_t count = json[kind.list_key].size();
  if (count > kind.most) {
    return fmt::format("{} {} are more than the {} that are kept", count, kind.list_key, kind.most);
  }
  return "";
}

}  // namespace

CompanionDesk::CompanionDesk(std::filesystem::path folder, const Keeps& keeps)
    : folder_(std::move(folder)), keeps_(keeps) {}

std::optional<CompanionDesk::Wanted> CompanionDesk::wanted_of(std::string_view rest) {
  for (const FileOfKind& file : kFiles) {
    if (rest.ends_with(file.suffix) && rest.size() > file.suffix.size()) {
      return Wanted{file.kind, rest.substr(0, rest.size() - file.suffix.size())};
    }
  }
  return std::nullopt;
}

bool CompanionDesk::is_brought(const HttpRequest& request) const {
  const std::string_view target = target_of(request);
  if (request.method() != http::verb::put || !target.starts_with(kCases)) {
    return false;
  }
  const std::optional<Wanted> wanted = wanted_of(target.substr(kCases.size()));
  return wanted && keeps(wanted->kind);
}

const char* CompanionDesk::kind_name(Kind kind) { return kind == Kind::kMarks ? "marks" : "tour"; }

void CompanionDesk::answer(const HttpRequest& request, const Wanted& wanted,
                           const std::function<void()>& before_change, Answer& answer) {
  const std::filesystem::path file =
      folder_ / (std::string(wanted.name) + std::string(file_of(wanted.kind).suffix));
  if (request.method() == http::verb::put) {
    take(request, wanted.kind, file, before_change, answer);
  } else {
    give(request, file, answer);
  }
}

void CompanionDesk::give(const HttpRequest& request, const std::filesystem::path& file,
                         Answer& answer) {
  std::optional<std::string> text = read_companion(file);
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

void CompanionDesk::take(const HttpRequest& request, Kind kind, const std::filesystem::path& file,
                         const std::function<void()>& before_change, Answer& answer) {
  const FileOfKind& known = file_of(kind);
  if (!keeps(kind)) {
    fail(answer, status::forbidden,
         fmt::format("this server keeps no {}; start it with clipgs serve FOLDER {}", known.noun,
                     known.option));
    return;
  }
  if (!is_from_own_page(request, kJson)) {
    fail(answer, status::forbidden,
         fmt::format("{} come from this server's own pages alone", known.noun));
    return;
  }
  if (const std::string problem = problem_of(request.body(), known); !problem.empty()) {
    fail(answer, status::unprocessable_entity, problem);
    return;
  }
  const std::scoped_lock lock(writing_);
  const std::optional<std::string> before = read_companion(file);
  const std::string_view wanted = header(request, field::if_match);
  const bool is_new = header(request, field::if_none_match) == "*";
  const bool is_known = before ? wanted == etag_of(*before) : is_new;
  if (!is_known) {
    fail(answer, status::precondition_failed,
         fmt::format("somebody else changed these {}; read them again", known.noun));
    return;
  }
  before_change();
  try {
    write_file(file, request.body().data(), request.body().size());
  } catch (const Error& error) {
    // Where it lies is for who runs the server.
    warn(error.what());
    fail(answer, status::insufficient_storage,
         fmt::format("{} cannot be written there; tell who runs this server",
                     file.filename().string()));
    return;
  }
  answer.head.result(status::no_content);
  answer.head.set(field::etag, etag_of(request.body()));
}

}  // namespace clipgs
