#pragma once

#include <span>
#include <string_view>

namespace clipgs {

/// One file of the viewer that web/ builds.
struct ViewerFile {
  std::string_view path;      ///< relative to the bundle: "index.html", "assets/…"
  std::string_view checksum;  ///< of its bytes, hexadecimal
  std::string_view bytes;
  std::string_view brotli;  ///< the same compressed; empty where that gains nothing
  std::string_view gzip;
};

/// The viewer, held by the program itself; empty if it was built without (CLIPGS_WEB).
std::span<const ViewerFile> viewer_files();

}  // namespace clipgs
