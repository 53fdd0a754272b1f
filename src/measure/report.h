#pragma once

#include <string>

#include "measure/evaluation.h"

namespace clipgs {

/// The evaluation as one self-contained HTML page (no scripts, no network): the table with its
/// noise floor, every picture's masked PSNR, and for the three worst, the median and the best
/// picture of each split the truth, ours under every operator, and the error side by side, and the
/// face enlarged where the case has a section; of other subjects one picture each. The selected
/// pictures are drawn again. Throws Error. `subjects` as in evaluate().
std::string evaluation_report(std::span<const Subject> subjects, const Dataset& dataset,
                              const Evaluation& evaluation);

}  // namespace clipgs
