#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tour/mark.h"

#include "core/camera.h"
#include "core/cut.h"
#include "core/image.h"
#include "section/section.h"

namespace clipgs {

/// A mark with what is said of it, and where its label stood last.
struct SaidMark {
  Mark mark;
  std::string text;
  std::optional<size_t> choice;
};

/// Marks as they are read in a section; null: there is none.
std::vector<SaidMark> said_marks(std::vector<Mark> marks, const Section* section);

/// Draws marks on a picture as the viewer does: their lines and points, and labels that keep clear
/// of each other. Those that lie on none of the faces that are seen are fainter; `body`: the ends
/// of the volume are faces, too.
void draw_marks(Image& picture, std::span<SaidMark> marks, const Camera& camera, const Cut& cut,
                const Section* section, bool body);

}  // namespace clipgs
