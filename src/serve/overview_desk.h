#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "serve/answer.h"

namespace clipgs {

/// Gives what `clipgs overview` wrote: /overview/ and beside it the pages and pictures of the
/// folder's overview/, *.html and *.webp. The overview's own script may run there, and no other.
class OverviewDesk {
 public:
  /// `folder`: that of the cases; "": there is no overview.
  explicit OverviewDesk(std::filesystem::path folder);

  /// Whether a path is one of these.
  static bool is_asked(std::string_view path);
  /// Of a path that is_asked(). Throws Error.
  void answer(const HttpRequest& request, std::string_view path, Answer& answer) const;

 private:
  std::filesystem::path folder_;
  std::string policy_;  ///< Content-Security-Policy
};

}  // namespace clipgs
