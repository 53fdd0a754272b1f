#pragma once

#include <filesystem>

#include "study/study_table.h"

namespace clipgs {

/// Reads what `clipgs serve --study` records: every SESSION.jsonl of the folder, a record a line
/// (records.h), as a row for each participant and mode. Measures: sus, efficiency and tlx of the
/// questionnaires; the mean over the tasks that are no practice, those that ran out of time
/// included, of seconds, travel_mm, rotation_deg, head_mm, head_deg, angle_deg, distance_mm,
/// regrasps and frame_ms, of each over the tasks where it was measured.
///
/// Of a session without its end the modes with SUS answers count, which come after a mode's tasks;
/// a session that a finished one of the same participant follows or precedes does not. Remarks say
/// so. Throws Error for a folder without sessions, a record that is not as it should be
/// ("file:line: …"), sessions of different plans, and a participant with two sessions of which not
/// just one is finished.
StudyTable read_study_sessions(const std::filesystem::path& folder);

}  // namespace clipgs
