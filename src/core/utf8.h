#pragma once

#include <string>
#include <string_view>

namespace clipgs {

/// Length of the UTF-8 sequence at the beginning of what is not empty; 0 if there is none
/// (surrogates, overlong forms and what lies beyond U+10FFFF are none).
size_t utf8_length(std::string_view text);

bool is_utf8(std::string_view text);

/// As much of it as `most` bytes hold, of whole characters.
std::string utf8_beginning(const std::string& text, size_t most);

}  // namespace clipgs
