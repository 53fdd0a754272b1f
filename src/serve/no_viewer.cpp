#include "serve/viewer_bundle.h"

namespace clipgs {

std::span<const ViewerFile> viewer_files() { return {}; }

}  // namespace clipgs
