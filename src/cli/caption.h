#pragma once

#include <string>

#include "core/image.h"

namespace clipgs {

/// Writes on a picture what is said of a view, its name and its text, at the upper left, and at the
/// upper right what no such picture is for. "": that is left out. RGBA, straight alpha.
void draw_caption(Image& picture, const std::string& name, const std::string& text);

}  // namespace clipgs
