#pragma once

#include <string>

namespace clipgs {

/// As a shell reads it as one word: bash and zsh, and every POSIX shell.
std::string shell_word(const std::string& text);

}  // namespace clipgs
