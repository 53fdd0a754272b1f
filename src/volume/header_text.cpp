#include "volume/header_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/letter_case.h"

namespace clipgs {
namespace {

constexpr std::string_view kBlanks = " \t\r\n\v\f";

}  // namespace

std::string_view trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(kBlanks);
  return begin == std::string_view::npos
             ? std::string_view()
             : text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::vector<std::string> words(std::string_view text) {
  std::vector<std::string> found;
  while (!(text = trimmed(text)).empty()) {
    const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
    found.emplace_back(word);
    text.remove_prefix(word.size());
  }
  return found;
}

std::string printable(std::string_view text) {
  constexpr size_t kShown = 40;
  std::string shown(text.substr(0, kShown));
  std::ranges::replace_if(shown, [](unsigned char c) { return c < ' ' || c > '~'; }, '?');
  return shown;
}

std::vector<double> numbers(std::string_view text, const std::string& field,
                            const std::string& where) {
  std::vector<double> values;
  for (const std::string& word : words(text)) {
    const std::string_view plain =
        word.starts_with('+') ? std::string_view(word).substr(1) : std::string_view(word);
    double value = 0;
    const auto [end, error] = std::from_chars(plain.data(), plain.data() + plain.size(), value);
    if (error != std::errc() || end != plain.data() + plain.size()) {
      throw Error("{}: its {} holds \"{}\", which is no number; the header is corrupt", where,
                  field, printable(word));
    }
    values.push_back(value);
  }
  return values;
}

std::vector<double> finite_numbers(std::string_view text, size_t count, const std::string& field,
                                   const std::string& where) {
  std::vector<double> values = numbers(text, field, where);
  if (values.size() != count) {
    throw Error("{}: its {} gives {} numbers, not {}; the header is corrupt", where, field,
                values.size(), count);
  }
  for (const double value : values) {
    if (!std::isfinite(value)) {
      throw Error("{}: its {} holds {}; the header is corrupt", where, field, value);
    }
  }
  return values;
}

std::int64_t whole_number(std::string_view text, std::int64_t least, std::int64_t most,
                          const std::string& field, const std::string& where) {
  const double value = finite_numbers(text, 1, field, where)[0];
  if (value != std::trunc(value) || value < static_cast<double>(least) ||
      value > static_cast<double>(most)) {
    throw Error("{}: its {} is {}; a whole number from {} to {} is needed", where, field, value,
                least, most);
  }
  return static_cast<std::int64_t>(value);
}

double millimetres_of(std::string_view unit) {
  using Unit = std::pair<std::string_view, double>;
  constexpr std::array kUnits{
      Unit{"mm", 1},         Unit{"millimeter", 1},   Unit{"millimeters", 1},
      Unit{"millimetre", 1}, Unit{"cm", 10},          Unit{"centimeter", 10},
      Unit{"m", 1000},       Unit{"meter", 1000},     Unit{"metre", 1000},
      Unit{"um", 1e-3},      Unit{"\xc2\xb5m", 1e-3}, Unit{"\xce\xbcm", 1e-3},
      Unit{"micron", 1e-3},  Unit{"microns", 1e-3},   Unit{"micrometer", 1e-3},
      Unit{"nm", 1e-6}};
  const std::string lower = lower_case(unit);
  const auto* const found =
      std::ranges::find(kUnits, std::string_view(lower), [](const Unit& u) { return u.first; });
  return found == kUnits.end() ? 0 : found->second;
}

std::vector<std::string> numbered_names(const std::string& pattern, std::int64_t first,
                                        std::int64_t last, std::int64_t step,
                                        const std::string& where) {
  constexpr std::int64_t kMostFiles = 1 << 16;
  const size_t percent = pattern.find('%');
  const size_t letter =
      percent == std::string::npos ? percent : pattern.find_first_not_of("0123456789", percent + 1);
  int width = 1;
  if (letter != std::string::npos) {
    std::from_chars(&pattern[percent] + 1, pattern.data() + pattern.size(), width);
  }
  if (letter == std::string::npos || pattern[letter] != 'd' || width > 9 ||
      pattern.find('%', letter) != std::string::npos) {
    throw Error("{}: names its data files \"{}\"; one number like %03d is needed", where,
                printable(pattern));
  }
  const bool zeros = pattern[percent + 1] == '0';
  const std::int64_t count = step == 0 ? 0 : (last - first) / step + 1;
  if (count < 1 || count > kMostFiles) {
    throw Error("{}: names its data files from {} to {} by {}; 1 to {} files are needed", where,
                first, last, step, kMostFiles);
  }
  std::vector<std::string> names;
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t number = first + i * step;
    names.push_back(
        pattern.substr(0, percent) +
        (zeros ? fmt::format("{:0{}}", number, width) : fmt::format("{:{}}", number, width)) +
        pattern.substr(letter + 1));
  }
  return names;
}

bool Lines::next(std::string_view& line) {
  const size_t end = text_.find('\n', at_);
  if (end == std::string_view::npos) {
    return false;
  }
  line = text_.substr(at_, end - at_);
  at_ = end + 1;
  if (line.ends_with('\r')) {
    line.remove_suffix(1);
  }
  return true;
}

}  // namespace clipgs
