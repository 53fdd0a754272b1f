#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "measure/overview.h"

namespace clipgs {

inline std::optional<double>& figure(OverviewEntry& entry, Figure which) {
  return entry.figures[static_cast<size_t>(which)];
}

/// How a figure is called, written and judged.
struct FigureKind {
  const char* title;     ///< of its column
  const char* in_words;  ///< "%": "faces", in a sentence
  const char* meaning;   ///< a sentence
  const char* unit;      ///< " dB"; may be empty
  int decimals;
  double scale = 1;       ///< it is shown times this
  int worse = 0;          ///< −1: less is worse, 1: more is; 0: either stands out
  bool is_ratio = false;  ///< twice as much is as far as half: its logarithm is compared
  double least = 0;       ///< what is compared differs by less where nobody minds
};
const FigureKind& figure_kind(size_t which);

/// "31.2 dB", or "–".
std::string figure_text(size_t which, const std::optional<double>& value);

/// Takes the figures of `clipgs eval --json`, of the first scene against the truth, faces drawn as
/// the viewer does. Of anything else: nothing.
void add_measured(const nlohmann::json& evaluation, OverviewEntry& entry);

/// Sets the reasons and scores of all, by each other's figures.
void say_what_stands_out(std::vector<OverviewEntry>& entries);

}  // namespace clipgs
