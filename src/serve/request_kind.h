#pragma once

#include <string_view>

namespace clipgs {

/// What a request asks for, as it is counted and logged.
enum class RequestKind {
  kPage,  ///< of the viewer, and what belongs to it
  kIndex,
  kCase,
  kThumbnail,
  kMarks,
  kTour,
  kStudy,
  kHealth,
  kMetrics,
  kOverview,
  kOther  ///< nothing that there is; perhaps a token with a letter wrong
};

/// Of a path without its query, decoded.
RequestKind request_kind(std::string_view path);
/// "page", "index", …
const char* kind_name(RequestKind kind);

}  // namespace clipgs
