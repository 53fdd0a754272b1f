#pragma once

#include <string>
#include <vector>

#include "study/records.h"

namespace clipgs::test {

/// A session of participant 7 with a record of every kind.
inline std::vector<StudyRecord> study_session() {
  return {{{"seq", 0},
           {"kind", "session"},
           {"format", 1},
           {"plan", "clipgs-vr"},
           {"digest", "0badcafe"},
           {"participant", 7},
           {"order", {"uniaxial", "arbitrary"}},
           {"device", "headset"}},
          {{"seq", 1},           {"kind", "task"},    {"mode", "uniaxial"}, {"task", "vessel"},
           {"practice", false},  {"outcome", "done"}, {"seconds", 31.25},   {"travel_mm", 120.5},
           {"rotation_deg", 0},  {"head_mm", 410.2},  {"head_deg", 61.5},   {"angle_deg", nullptr},
           {"distance_mm", 2.1}, {"regrasps", 2},     {"restarts", 0},      {"frames", 2250},
           {"frame_ms", 13.9},   {"low_fps", 61.5},   {"dropped", 4},       {"display_hz", 72}},
          {{"seq", 2},
           {"kind", "answers"},
           {"mode", "uniaxial"},
           {"questionnaire", "sus"},
           {"answers", {5, 1, 5, 1, 5, 1, 5, 1, 5, 1}}},
          {{"seq", 3},
           {"kind", "answers"},
           {"mode", "uniaxial"},
           {"questionnaire", "efficiency"},
           {"answers", StudyRecord::array({4})}},
          {{"seq", 4}, {"kind", "comment"}, {"text", "a \"fine\" tool, this"}},
          {{"seq", 5}, {"kind", "end"}}};
}

/// Records from `first` to before `end`, a line each.
inline std::string study_lines(size_t first = 0, size_t end = 6) {
  std::string text;
  for (size_t i = first; i < end; ++i) {
    text += study_session()[i].dump() + '\n';
  }
  return text;
}

}  // namespace clipgs::test
