#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace clipgs {

/// Letters, digits and "-._~", which addresses have as they are (RFC 3986, 2.3).
bool is_unreserved(char c);

/// All but unreserved characters as %XX (RFC 3986).
std::string percent_encode(std::string_view text);
/// The reverse; nothing where a % is not followed by two hexadecimal digits.
std::optional<std::string> percent_decode(std::string_view text);

}  // namespace clipgs
