// Premultiplied display sRGB, blended over what lies behind.
precision highp float;
precision highp int;

#include "gaussian.glsl"

in vec2 vPosition;
in float vPlane[kPlanes];
flat in vec4 vColor;

uniform int uSlabs;

out vec4 fragColor;

void main() {
  float alpha = vColor.a * keptShare(vPlane, uSlabs) * exp(-0.5 * dot(vPosition, vPosition));
  if (alpha < kAlphaMin) {
    discard;
  }
  alpha = min(alpha, kAlphaMax);
  fragColor = vec4(vColor.rgb * alpha, alpha);
}
