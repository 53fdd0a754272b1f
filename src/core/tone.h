#pragma once

#include <array>
#include <optional>
#include <string>

namespace clipgs {

/// How light is brought into the range of a display, each channel by itself, before the sRGB curve.
enum class ToneCurve {
  kSrgb,    ///< not at all: what is brighter than 1 is clipped
  kFilmic,  ///< Hable 2010, white at 2: a soft shoulder, and 0.18 stays what it is
};

/// Names of the curves, in their order.
inline constexpr std::array<const char*, 2> kToneNames = {"srgb", "filmic"};
const char* tone_name(ToneCurve tone);
/// Nothing, if there is no such curve.
std::optional<ToneCurve> tone_of_name(const std::string& name);
/// "srgb, filmic": for errors.
std::string tone_names();

/// How light becomes a picture: sRGB(tone(exposure · light)).
struct DisplayTransform {
  float exposure = 1;  ///< linear factor
  ToneCurve tone = ToneCurve::kSrgb;
};

/// Exposed linear light, of which less than 0 counts as 0, as the share of a display's light that
/// shows it: increasing up to 1.
float toned(float light, ToneCurve tone);
/// The least light that is shown as a share of [0, 1]; shares beyond count as its ends.
float untoned(float share, ToneCurve tone);

/// The same with the sRGB curve: exposed linear light as display sRGB in [0, 1], and back.
float display_from_linear(float light, ToneCurve tone);
float linear_from_display(float srgb, ToneCurve tone);

}  // namespace clipgs
