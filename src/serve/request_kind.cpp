#include "serve/request_kind.h"

#include <algorithm>

#include "serve/companion_desk.h"
#include "serve/overview_desk.h"
#include "serve/study_desk.h"
#include "serve/viewer_bundle.h"

namespace clipgs {

namespace {

constexpr std::string_view kCases = "/cases/";

RequestKind kind_of_case(std::string_view rest) {
  if (const auto wanted = CompanionDesk::wanted_of(rest)) {
    return wanted->kind == CompanionDesk::Kind::kMarks ? RequestKind::kMarks : RequestKind::kTour;
  }
  return rest.ends_with("/thumbnail") ? RequestKind::kThumbnail
         : rest.ends_with(".sog")     ? RequestKind::kCase
                                      : RequestKind::kOther;
}

}  // namespace

RequestKind request_kind(std::string_view path) {
  if (path.starts_with(kCases)) {
    return kind_of_case(path.substr(kCases.size()));
  }
  if (path == "/api/cases") {
    return RequestKind::kIndex;
  }
  if (path == "/health") {
    return RequestKind::kHealth;
  }
  if (path == "/metrics") {
    return RequestKind::kMetrics;
  }
  if (StudyDesk::is_asked(path)) {
    return RequestKind::kStudy;
  }
  if (OverviewDesk::is_asked(path)) {
    return RequestKind::kOverview;
  }
  if (!path.starts_with('/')) {
    return RequestKind::kOther;
  }
  const std::string_view page = path.substr(1);
  const bool is_page =
      page.empty() || std::ranges::count(viewer_files(), page, &ViewerFile::path) > 0;
  return is_page ? RequestKind::kPage : RequestKind::kOther;
}

const char* kind_name(RequestKind kind) {
  switch (kind) {
    case RequestKind::kPage:
      return "page";
    case RequestKind::kIndex:
      return "index";
    case RequestKind::kCase:
      return "case";
    case RequestKind::kThumbnail:
      return "thumbnail";
    case RequestKind::kMarks:
      return "marks";
    case RequestKind::kTour:
      return "tour";
    case RequestKind::kStudy:
      return "study";
    case RequestKind::kHealth:
      return "health";
    case RequestKind::kMetrics:
      return "metrics";
    case RequestKind::kOverview:
      return "overview";
    case RequestKind::kOther:
      break;
  }
  return "other";
}

}  // namespace clipgs
