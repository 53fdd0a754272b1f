#include "core/letter_case.h"

namespace clipgs {

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return result;
}

bool is_alike(std::string_view one, std::string_view other) {
  return lower_case(one) == lower_case(other);
}

}  // namespace clipgs
