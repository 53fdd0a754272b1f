#pragma once

#include <string>
#include <string_view>

#include "core/image.h"

namespace clipgs {

/// Text made safe for HTML content and double-quoted attributes.
std::string escape_html(std::string_view text);

/// RGB in [0, 1] as a WebP of high quality in a data URI. Throws Error.
std::string data_uri(const Image& rgb);

/// [height, width, 1] in [0, 1] as colours from black through red and yellow to white.
Image heat_map(const Image& grey);

}  // namespace clipgs
