#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "serve/answer.h"

namespace clipgs {

/// What people make of cases beside them (docs/format.md): what they marked, and the views that
/// they saved, a file of each kind beside each case:
///
///   /cases/NAME.marks.json, /cases/NAME.tour.json
///     GET; PUT (application/json) where that kind is kept
///
/// Who puts names what it changed by If-Match, or says by If-None-Match: * that there was nothing.
/// Where somebody else was faster (412) nothing is written, and what is there is to be read again;
/// what cannot be written is answered with 507, what is no such file with 422, and why.
class CompanionDesk {
 public:
  enum class Kind : std::uint8_t { kMarks, kTour };
  /// Of each kind, whether it may be changed.
  struct Keeps {
    bool marks = false;
    bool tours = false;
  };
  /// A file that is asked for.
  struct Wanted {
    Kind kind;
    std::string_view name;  ///< of the case
  };

  /// Beside the cases of a folder.
  CompanionDesk(std::filesystem::path folder, const Keeps& keeps);

  /// What the path behind /cases/ asks for, if it is one of these files.
  static std::optional<Wanted> wanted_of(std::string_view rest);
  /// Whether a request brings something that is kept, which is to be read before it is answered.
  bool is_brought(const HttpRequest& request) const;

  const Keeps& keeps() const { return keeps_; }
  /// "marks", "tour".
  static const char* kind_name(Kind kind);
  /// Of a case that there is. `before_change`: is called before one; what it throws prevents it.
  void answer(const HttpRequest& request, const Wanted& wanted,
              const std::function<void()>& before_change, Answer& answer);

 private:
  bool keeps(Kind kind) const { return kind == Kind::kMarks ? keeps_.marks : keeps_.tours; }
  static void give(const HttpRequest& request, const std::filesystem::path& file, Answer& answer);
  void take(const HttpRequest& request, Kind kind, const std::filesystem::path& file,
            const std::function<void()>& before_change, Answer& answer);

  std::filesystem::path folder_;
  Keeps keeps_;
  std::mutex writing_;  ///< held from a look at what is there to its replacement
};

}  // namespace clipgs
