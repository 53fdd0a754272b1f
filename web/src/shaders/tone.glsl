// How light is displayed: sRGB(tone(light)), of exposed linear light. The twin of src/core/tone.cpp. `filmic`: whether
// the tone curve is Hable's with its white at a light of 2, or none.

#include "srgb.glsl"

const float kBias = 2.0;
const float kWhite = 4.0;
const float kShoulder = 0.15;
const float kSlope = 0.5;
const float kToe = 0.2 * 0.3;
const float kLift = 0.02 / 0.3;
const float kRise = kShoulder * (1.0 - kLift);
const float kStart = kSlope * (0.1 - kLift);
const float kWhiteShown = kWhite * (kRise * kWhite + kStart) / (kWhite * (kShoulder * kWhite + kSlope) + kToe);

vec3 displayFromLinear(vec3 light, bool filmic) {
  if (filmic) {
    vec3 x = clamp(kBias * light, 0.0, kWhite);
    light = x * (kRise * x + kStart) / (x * (kShoulder * x + kSlope) + kToe) / kWhiteShown;
  }
  return srgbFromLinear(light);
}

// Of colours of [0, 1].
vec3 linearFromDisplay(vec3 srgb, bool filmic) {
  vec3 light = linearFromSrgb(srgb);
  if (filmic) {
    vec3 y = kWhiteShown * light;
    vec3 b = kStart - kSlope * y;
    light = 2.0 / kBias * kToe * y / (b + sqrt(b * b + 4.0 * (kRise - kShoulder * y) * kToe * y));
  }
  return light;
}
