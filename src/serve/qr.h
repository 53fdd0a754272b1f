#pragma once

#include <string>

namespace clipgs {

/// `text` as a QR code (ISO/IEC 18004) of UTF-8 half blocks, dark on light whatever the terminal's
/// colours, lines ending in '\n'. Throws Error if it is too long.
std::string qr_code(const std::string& text);

}  // namespace clipgs
