#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "core/error.h"

namespace clipgs {

/// A line of what a session of a study records, its fields in the order in which they are written.
using StudyRecord = nlohmann::ordered_json;

/// A record that is not as it should be.
class RefusedRecord : public Error {
 public:
  using Error::Error;
};

/// Reads one line of JSON as a record. Every record has its number `seq`, 0, 1, ... within its
/// session, and a `kind`:
///
///   session   seq 0: format (1), plan, digest of the plan, participant (1..9999), order (modes),
///   device (headset, desk) task      mode, task, practice, outcome (done, time), seconds,
///   travel_mm and rotation_deg of
///             the plane, head_mm and head_deg, angle_deg and distance_mm from the target at the
///             end, regrasps, restarts, frames, frame_ms (mean), low_fps (of the slowest 1 %),
///             dropped (frames), display_hz; what was not measured is null
///   answers   mode, questionnaire (sus: ten of 1..5, efficiency: one of 1..5, tlx: six of 0..100),
///             answers
///   comment   text, at most 4000 bytes
///   end
///
/// This list is all that is ever recorded: a record with another field, without one of these, or
/// with a value out of its range is refused. `name`: for errors. Throws RefusedRecord.
StudyRecord parse_record(std::string_view line, const std::string& name);

/// The same as one row of comma-separated values, without the line's end; the header of such rows.
std::string csv_of_record(const StudyRecord& record);
std::string csv_header_of_records();

/// Whether this can name a mode, a task or a plan: 1 to 64 letters, digits, strokes.
bool is_study_name(std::string_view text);

}  // namespace clipgs
