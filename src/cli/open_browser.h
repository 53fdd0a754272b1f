#pragma once

#include <string>

namespace clipgs {

/// Shows an address in the browser that the user likes best: $BROWSER, or else the desktop's.
/// Where there is none, or it fails, a warning says what to open.
void open_browser(const std::string& url);

}  // namespace clipgs
