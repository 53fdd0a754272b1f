#include "core/error.h"

#include <cstdio>

namespace clipgs {

void warn(const std::string& message) { fmt::print(stderr, "warning: {}\n", message); }

}  // namespace clipgs
