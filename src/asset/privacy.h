#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace clipgs {

/// Something that a case says of where it comes from.
struct PrivacyNote {
  std::string where;  ///< "title", "section.origin", or the name of a file in the case
  std::string value;  ///< as it stands there, shortened; empty where it is no text
  std::string what;   ///< what it tells, and to whom
  /// No clipgs writes this: somebody, or another program, put it there.
  bool foreign = false;
};

/// All that a case says of its origin: texts, dates, digests, sizes and places, by a list of what
/// clipgs writes (docs/format.md), and whatever in the file is not on that list, metadata of images
/// included. What somebody might recognise in the body itself is one of the notes, and so are marks
/// and tours beside the file. Throws Error if it is no case.
std::vector<PrivacyNote> privacy_notes(const std::filesystem::path& path);

}  // namespace clipgs
