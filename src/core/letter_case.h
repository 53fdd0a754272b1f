#pragma once

#include <string>
#include <string_view>

namespace clipgs {

/// With the letters A to Z made small and all other bytes as they are, whatever the locale.
std::string lower_case(std::string_view text);

/// Whether texts differ at most in the case of the letters A to Z.
bool is_alike(std::string_view one, std::string_view other);

}  // namespace clipgs
