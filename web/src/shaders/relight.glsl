// How splats follow the light: of another rig, and of the cut, whose shadows are others. The twin of OpenedLight::gain
// in src/section/openings.cpp and of src/section/relight.cpp.

#include "tone.glsl"

const float kDim = 0.001;
const float kMostGain = 10.0;
const float kBlack = 0.001;

struct SplatLight {
  bool changed;         // else every gain is 1
  mat4 cellFromScene;
  vec3 cells;
  float scale;          // what 1 in the texture of the light stands for …
  float ownScale;       // … and in that of the light that the case was made in
  bool filmic;          // the tone curve of the case's pictures
};

// A factor of linear RGB for what lies at a point (scene space) with its shortest axis along `axis`.
vec3 lightGain(vec3 position, vec3 axis, SplatLight l, highp sampler3D light, highp sampler3D ownLight) {
  vec3 n = normalize(mat3(l.cellFromScene) * axis);
  vec3 at = clamp((l.cellFromScene * vec4(position, 1.0)).xyz, vec3(0.0), l.cells - 1.0) + 0.5;
  vec3 before = vec3(0.0), now = vec3(0.0);
  for (int side = 0; side < 6; ++side) {
    vec3 texel = vec3(at.xy, at.z + float(6 + side) * l.cells.z) / vec3(l.cells.xy, 12.0 * l.cells.z);
    float share = n[side / 2] * n[side / 2];
    before += share * texture(ownLight, texel).rgb;
    now += share * texture(light, texel).rgb;
  }
  before *= l.ownScale;
  now *= l.scale;
  if (before.g <= 0.0) {
    return vec3(1.0);
  }
  vec3 dim = vec3(kDim * before.g);
  return clamp((now + dim) / (before + dim), 1.0 / kMostGain, kMostGain);
}

// A factor of linear light as one of a color in display sRGB.
vec3 displayGain(vec3 gain, vec3 color, bool filmic) {
  vec3 bounded = clamp(color, kBlack, 1.0);
  return displayFromLinear(gain * linearFromDisplay(bounded, filmic), filmic) / bounded;
}
