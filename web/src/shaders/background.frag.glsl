// What lies behind the case, dithered so that it shows no bands.
precision highp float;

#include "depth_cue.glsl"

uniform Backdrop uBackdrop;

out vec4 fragColor;

void main() {
  vec3 color = backdropAt(gl_FragCoord.xy, uBackdrop);
  // Interleaved gradient noise (Jimenez 2014), ± half a step of 8 bits.
  float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  fragColor = vec4(color + (noise - 0.5) / 255.0, 1.0);
}
