#pragma once

namespace clipgs {

/// Alpha above which a pixel shows matter: masked figures count these alone.
constexpr float kMaskAlpha = 0.01f;

}  // namespace clipgs
