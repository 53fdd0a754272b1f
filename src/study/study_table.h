#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace clipgs {

/// What one participant gave in one mode.
struct StudyRow {
  std::string participant;  ///< a number, as text without zeros in front, or another short name
  std::string mode;
  std::string place;                                   ///< "file:line", for messages
  std::map<std::string, double> values;                ///< by measure
  std::map<std::string, std::string> missing;          ///< why a measure has no value here
  std::map<std::string, std::vector<double>> answers;  ///< of "sus" and "tlx", where they are known
};

/// A study: no participant has two rows of one mode.
struct StudyTable {
  std::vector<std::string> measures;  ///< as measure_order() has them
  std::vector<StudyRow> rows;
  std::vector<std::string> remarks;  ///< sentences on what was left out on the way here
};

/// Adds the rows of another table. Throws Error, naming both places, for a participant who would
/// have two rows of one mode.
void join(StudyTable& table, StudyTable other);

/// A measure's name for people, and its unit ("" where there is none).
struct MeasureTitle {
  std::string title;
  std::string unit;
};
MeasureTitle measure_title(const std::string& measure);

/// Whether a comes before b: measures that are known in the order of a study's report (sus,
/// efficiency, tlx, then what is recorded of tasks), others behind them by name.
bool measure_order(const std::string& a, const std::string& b);

/// Whether a comes before b: numbers by value, then names.
bool participant_order(const std::string& a, const std::string& b);

/// The table as CSV that read_study_csv() reads: participant, mode, then q1…q10 in place of sus and
/// tlx1…tlx6 in place of tlx where every row has its answers or none, then the other measures.
/// Values are written so that they read back the same; what is missing is an empty cell.
std::string study_csv(const StudyTable& table);

}  // namespace clipgs
