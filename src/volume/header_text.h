#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// What the headers of NRRD and MetaImage have in common: they are lines of text.

namespace clipgs {

/// Without blanks at either end.
std::string_view trimmed(std::string_view text);
std::vector<std::string> words(std::string_view text);

/// The beginning of a text from a file, fit for a message.
std::string printable(std::string_view text);

/// Numbers that blanks separate. Throws Error, naming the field, for anything else; NaN and
/// infinity are numbers here.
std::vector<double> numbers(std::string_view text, const std::string& field,
                            const std::string& where);
/// Exactly `count` finite numbers. Throws Error.
std::vector<double> finite_numbers(std::string_view text, size_t count, const std::string& field,
                                   const std::string& where);
/// A whole number from `least` to `most`. Throws Error.
std::int64_t whole_number(std::string_view text, std::int64_t least, std::int64_t most,
                          const std::string& field, const std::string& where);

/// Millimetres of a unit of length as people write it ("mm", "um", "microns", "cm", "m"), or 0.
double millimetres_of(std::string_view unit);

/// The names "slice%03d.raw" stands for, for numbers from `first` to `last`. Throws Error for
/// another format, and for more than 2^16 files.
std::vector<std::string> numbered_names(const std::string& pattern, std::int64_t first,
                                        std::int64_t last, std::int64_t step,
                                        const std::string& where);

/// Takes a text apart into lines, "\n" or "\r\n" at their ends.
class Lines {
 public:
  explicit Lines(std::span<const std::uint8_t> bytes)
      : text_(reinterpret_cast<const char*>(bytes.data()), bytes.size()) {}

  /// The next line; false at the end, and for a last line that does not end.
  bool next(std::string_view& line);
  /// What is left after the last whole line, as one more line.
  std::string_view rest() const { return text_.substr(at_); }
  size_t position() const { return at_; }

 private:
  std::string_view text_;
  size_t at_ = 0;
};

}  // namespace clipgs
