#pragma once

namespace clipgs {

/// Of the program, as `clipgs --version` says it, e.g. "0.1.0".
const char* program_version();

}  // namespace clipgs
