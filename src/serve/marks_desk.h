#pragma once

#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>

#include "serve/answer.h"

namespace clipgs {

/// What people marked of cases (docs/format.md), a file beside each, NAME.marks.json:
///
///   /cases/NAME.marks.json   GET; PUT (application/json) where they are kept
///
/// Who puts names what it changed by If-Match, or says by If-None-Match: * that there was nothing.
/// Where somebody else was faster (412) nothing is written, and what is there is to be read again;
/// what cannot be written is answered with 507, what is no file of marks with 422, and why.
class MarksDesk {
 public:
  /// Beside the cases of a folder. `keeps`: whether they may be changed.
  MarksDesk(std::filesystem::path folder, bool keeps);

  /// Of the path behind /cases/: the name of the case whose marks are asked for, or "".
  static std::string_view case_of(std::string_view rest);
  /// Whether a request brings marks, which are to be read before it is answered.
  static bool brings_marks(const HttpRequest& request);

  bool keeps() const { return keeps_; }
  /// Of a case that there is.
  void answer(const HttpRequest& request, const std::string& name, Answer& answer);

 private:
  void give(const HttpRequest& request, const std::filesystem::path& file, Answer& answer) const;
  void take(const HttpRequest& request, const std::filesystem::path& file, Answer& answer);

  std::filesystem::path folder_;
  bool keeps_;
  std::mutex writing_;  ///< held from a look at what is there to its replacement
};

}  // namespace clipgs
