#include "core/tone.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/image.h"

namespace clipgs {
namespace {

// Hable's curve ((x(Ax + CB) + DE) / (x(Ax + B) + DF) − E/F with his constants and his exposure of
// 2 (J. Hable, Filmic tonemapping operators, 2010), as x(Px + Q) / (x(Ax + B) + DF), which is 0 at
// 0 whatever is rounded. His white, 11.2, is for outdoor scenes; matter that reflects what lamps
// send seldom shows more than twice its white: with white at 4, which is a light of 2, colours lose
// least and 0.18 stays.
constexpr float kA = 0.15f;
constexpr float kB = 0.5f;
constexpr float kC = 0.1f;
constexpr float kDF = 0.2f * 0.3f;
constexpr float kEOverF = 0.02f / 0.3f;
constexpr float kP = kA * (1 - kEOverF);
constexpr float kQ = kB * (kC - kEOverF);
constexpr float kBias = 2;
constexpr float kWhite = 4;

constexpr float hable(float x) { return x * (kP * x + kQ) / (x * (kA * x + kB) + kDF); }

/// The root of (P − Ay)x² + (Q − By)x − DFy that is not negative, without cancellation at 0.
float inverse_hable(float y) {
  const float a = kP - kA * y;
  const float b = kQ - kB * y;
  const float c = kDF * y;
  return 2 * c / (b + std::sqrt(b * b + 4 * a * c));
}

}  // namespace

const char* tone_name(ToneCurve tone) { return kToneNames[static_cast<size_t>(tone)]; }

std::optional<ToneCurve> tone_of_name(const std::string& name) {
  const auto* const found = std::ranges::find(kToneNames, name);
  return found == kToneNames.end()
             ? std::nullopt
             : std::optional(static_cast<ToneCurve>(found - kToneNames.begin()));
}

std::string tone_names() { return fmt::format("{}", fmt::join(kToneNames, ", ")); }

float toned(float light, ToneCurve tone) {
  if (tone == ToneCurve::kFilmic) {
    return hable(std::clamp(kBias * light, 0.0f, kWhite)) / hable(kWhite);
  }
  return std::clamp(light, 0.0f, 1.0f);
}

float untoned(float share, ToneCurve tone) {
  const float y = std::clamp(share, 0.0f, 1.0f);
  return tone == ToneCurve::kFilmic ? inverse_hable(y * hable(kWhite)) / kBias : y;
}

float display_from_linear(float light, ToneCurve tone) {
  return srgb_from_linear(toned(light, tone));
}

float linear_from_display(float srgb, ToneCurve tone) {
  return untoned(linear_from_srgb(srgb), tone);
}

}  // namespace clipgs
