#include "serve/case_desk.h"

#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "core/error.h"
#include "serve/http.h"

namespace clipgs {

namespace {

namespace http = boost::beast::http;
using http::field;
using http::status;

constexpr std::string_view kCaseSuffix = ".sog";
constexpr std::string_view kThumbnailSuffix = "/thumbnail";
// What a page calls itself when it asks what cases there are, and how it says that it is closed.
constexpr std::string_view kPage = "?page=";
constexpr std::string_view kLeft = "&left";
// Not for proxies, which would give them to those who may not see them.
constexpr const char* kPrivate = "private, no-cache";
constexpr const char* kPrivateForEver = "private, max-age=31536000, immutable";
constexpr const char* kNoCase = "there is no such case; choose another from the menu";

void give_case(const HttpRequest& request, Answer& answer, const CaseEntry& entry,
               const std::shared_ptr<const OpenFile>& file) {
  const FileState& state = file->state();
  const std::string etag = '"' + state.version + '"';
  answer.head.set(field::cache_control, kPrivate);
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
  answer.head.set(field::cache_control, versioned ? kPrivateForEver : kPrivate);
  if (!not_modified(request, answer, "\"t" + entry->version + '"')) {
    answer.head.set(field::content_type, "image/webp");
    answer.body = source_of({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, entry);
  }
}

}  // namespace

CaseDesk::CaseDesk(const CaseDeskOptions& options)
    : live_(options.live),
      index_(options.folder, options.only, options.subfolders),
      companions_(options.folder, options.keeps),
      openings_(options.audit) {}

std::optional<Metrics::Cases> CaseDesk::count() {
  try {
    const CaseEntries entries = index_.list();
    const auto shown = static_cast<size_t>(
        std::ranges::count_if(entries, [](const auto& entry) { return entry->error.empty(); }));
    return Metrics::Cases{shown, entries.size() - shown};
  } catch (const Error&) {
    return std::nullopt;
  }
}

void CaseDesk::give_list(std::string_view query, const Grant& grant, Answer& answer) {
  CaseEntries entries = index_.list();
  std::erase_if(entries, [&](const auto& entry) { return !grant.may_see(entry->name); });
  nlohmann::json json = case_index_json(entries);
  json["keeps_marks"] = companions_.keeps().marks && grant.writes;
  json["keeps_tours"] = companions_.keeps().tours && grant.writes;
  if (live_ != nullptr) {
    json["making"] = live_->json();
    if (query.starts_with(kPage)) {
      std::string page(query.substr(kPage.size()));
      if (page.ends_with(kLeft)) {
        page.resize(page.size() - kLeft.size());
        live_->page_left(page);
      } else {
        live_->page_seen(page);
      }
    }
  }
  give_text(answer, status::ok, "application/json",
            json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

void CaseDesk::give_of_case(const HttpRequest& request, std::string_view rest, bool versioned,
                            const Client& client, const Grant& grant, Answer& answer) {
  if (const std::optional wanted = CompanionDesk::wanted_of(rest)) {
    give_companion(request, *wanted, client, grant, answer);
    return;
  }
  const bool thumbnail = rest.ends_with(kThumbnailSuffix);
  const std::string_view suffix = thumbnail ? kThumbnailSuffix : kCaseSuffix;
  const std::string name(rest.substr(0, rest.size() - std::min(suffix.size(), rest.size())));
  const auto entry = rest.ends_with(suffix) && grant.may_see(name) ? index_.find(name) : nullptr;
  if (entry == nullptr) {
    fail(answer, status::not_found, kNoCase);
  } else if (!entry->error.empty()) {
    fail(answer, status::unprocessable_entity, entry->error);
  } else if (thumbnail) {
    give_thumbnail(request, answer, entry, versioned);
  } else {
    const std::shared_ptr<const OpenFile> file = index_.open(*entry);
    if (request.method() == http::verb::get) {
      openings_.note(client, grant.name, *entry);
    }
    give_case(request, answer, *entry, file);
  }
}

void CaseDesk::give_companion(const HttpRequest& request, const CompanionDesk::Wanted& wanted,
                              const Client& client, const Grant& grant, Answer& answer) {
  const std::string name(wanted.name);
  const auto entry = grant.may_see(name) ? index_.find(name) : nullptr;
  if (entry == nullptr) {
    fail(answer, status::not_found, kNoCase);
  } else if (request.method() == http::verb::put && !grant.writes) {
    fail(answer, status::forbidden, "your address lets you look alone; ask for one that may write");
  } else {
    const char* const what = CompanionDesk::kind_name(wanted.kind);
    companions_.answer(
        request, wanted, [&] { openings_.note_change(client, grant.name, *entry, what); }, answer);
  }
}

}  // namespace clipgs
