#include "measure/build_notes.h"

#include <algorithm>
#include <array>
#include <regex>

namespace clipgs {

namespace {

/// A warning's words, and how they are put without what is around them; $1 is their number.
struct Known {
  const char* words;
  const char* note;
};

constexpr std::array kKnown = {
    Known{R"(took (\d+) ml of table)", "$1 ml of table and cushions taken off"},
    Known{R"(at least (\d+) ml of something solid)",
          "at least $1 ml of something solid beside the body left in"},
    Known{"the table cannot be told from the body", "a table may show, it was not taken off"},
    Known{"looks like a scanner's table", "a table may show, its kind is unknown"},
    Known{R"(([\d.]+) % of the voxels have the value)",
          "$1 % of the voxels lie outside the picture"},
    Known{"its values gather as CT's do, but are no HU", "values like CT's, but no HU"},
    Known{R"(softened the streaks of ([\d.e+-]+) ml of metal)",
          "streaks of $1 ml of metal softened"},
    Known{R"(averaged noise of ([\d.e+-]+(?: HU)?) away)", "noise of $1 averaged away"},
    Known{"evened out a field of", "the coils' bias evened out"},
    Known{": cropped to ", "cropped"},
    Known{R"((\d+) images share their position)", "$1 images share their position with another"},
    Known{"interpolated from their neighbours", "missing slices interpolated"},
    Known{R"(gantry tilted by ([\d.]+) degrees)", "gantry tilted by $1 degrees, resampled"},
    Known{R"(slices ([\d.]+ to [\d.]+) mm apart)", "slices $1 mm apart, resampled"},
    Known{R"((\d+) series or phases:)", "one of $1 series or phases taken"},
    Known{R"(left out (\d+) file\(s\) of other series)", "$1 files of other series cannot be read"},
    Known{"is made for .*, and the volume is ", "the look is made for another modality"},
};

constexpr const char* kUnknown = "another warning: see the log";

}  // namespace

std::optional<std::string> note_of_warning(std::string_view line) {
  constexpr std::string_view kWarning = "warning: ";
  constexpr size_t kMost = 4096;  // of a line that is looked at; std::regex recurses
  if (!line.starts_with(kWarning)) {
    return std::nullopt;
  }
  const std::string text(line.substr(0, kMost));
  for (const Known& known : kKnown) {
    std::smatch found;
    if (std::regex_search(text, found, std::regex(known.words))) {
      return found.format(known.note);
    }
  }
  return kUnknown;
}

std::vector<std::string> notes_of_log(std::string_view log) {
  std::vector<std::string> notes;
  while (!log.empty()) {
    const size_t end = std::min(log.find('\n'), log.size());
    const std::optional<std::string> note = note_of_warning(log.substr(0, end));
    if (note && std::ranges::find(notes, *note) == notes.end()) {
      notes.push_back(*note);
    }
    log.remove_prefix(std::min(end + 1, log.size()));
  }
  return notes;
}

std::string without_names(std::string_view line) {
  constexpr size_t kMost = 400;
  std::string text(line.substr(0, kMost));
  // A path's folders may have spaces in them: it ends where the message begins, at ": " or "; ".
  static const std::regex paths(R"((?:^|[^\s:;,(="']*)/(?:(?![:;,)]\s|["']|$).)*)");
  static const std::regex quoted(R"("[^"]*")");
  static const std::regex uids(R"(\b\d+(?:\.\d+){3,})");
  text = std::regex_replace(text, quoted, "\"…\"");
  text = std::regex_replace(text, paths, "…");
  return std::regex_replace(text, uids, "…");
}

}  // namespace clipgs
