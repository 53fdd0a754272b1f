#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace clipgs {

/// What a warning of a build says of its volume, in words of a fixed list with its numbers and
/// nothing else of the line: warnings name files, and these patients. Nothing for a line that is
/// no warning; "another warning: see the log" for one that is not in the list.
std::optional<std::string> note_of_warning(std::string_view line);

/// The notes of a log's warnings, each once, in their order.
std::vector<std::string> notes_of_log(std::string_view log);

/// An error's line without what may name a patient: paths, UIDs and what stands in quotation marks.
std::string without_names(std::string_view line);

}  // namespace clipgs
