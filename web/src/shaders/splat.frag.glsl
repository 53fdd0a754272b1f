// Premultiplied display sRGB, blended over what lies behind.
precision highp float;
precision highp int;

#include "gaussian.glsl"

in vec3 vPosition;
flat in vec4 vColor;
out vec4 fragColor;

void main() {
  float alpha = vColor.a * exp(-0.5 * dot(vPosition.xy, vPosition.xy));
  if (vPosition.z < 6.0) {  // Φ(6) differs from 1 by less than a float can tell
    alpha *= normalCdf(vPosition.z);
  }
  if (alpha < kAlphaMin) {
    discard;
  }
  alpha = min(alpha, kAlphaMax);
  fragColor = vec4(vColor.rgb * alpha, alpha);
}
