#pragma once

#include <cstddef>
#include <future>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "asset/webp.h"
#include "asset/zip.h"
#include "section/section.h"

namespace clipgs {

/// A section as a case holds it.
struct CodedSection {
  nlohmann::json block;
  ZipEntry file;

  size_t bytes() const;  ///< about what it adds to a case
};

/// A section by ever lower qualities of its voxels, or by one that is given. Coding takes seconds:
/// each is coded once, and what it will take is first read off a part of the slices.
class SectionCodings {
 public:
  /// Keeps a reference to `section`. `given`: see CaseCoding::section_quality; by that it is coded
  /// at once, beside whatever else is done.
  SectionCodings(const Section& section, std::optional<float> given, Saving saving);

  /// The best that takes no more than `room` bytes (without loss: half a megabyte), or the
  /// smallest. What does not fit by one is not tried by a better one. Throws Error.
  const CodedSection& best(size_t room);

 private:
  size_t estimate(size_t index);
  const CodedSection& by(float quality);

  const Section& section_;
  std::optional<float> given_;
  Saving saving_;
  Section sample_;  ///< of its slices
  std::map<size_t, size_t> estimates_;
  std::map<float, CodedSection> coded_;
  std::future<CodedSection> coming_;  ///< by `given_`, until it is asked for
};

}  // namespace clipgs
