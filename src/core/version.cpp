#include "core/version.h"

namespace clipgs {

const char* program_version() { return CLIPGS_VERSION; }

}  // namespace clipgs
