#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "measure/overview.h"

namespace clipgs {

/// The entries, in their order, as one HTML page that needs no network: pictures lie beside it,
/// NAME.webp, and are fetched when they come into sight, as reports, NAME.html. Where a server has
/// it at /overview/, it leads to the cases in the viewer as well.
std::string overview_page(const std::vector<OverviewEntry>& entries);

/// The one script of the page, for a server that says which may run.
std::string_view overview_script();

/// gather_overview(), and all of the page into FOLDER/overview/: index.html and the pictures.
/// Returns what was gathered. Throws Error.
std::vector<OverviewEntry> write_overview(const std::filesystem::path& folder);

}  // namespace clipgs
