// A quiet gradient behind the case, dithered so that it shows no bands.
precision highp float;

uniform vec2 uSize;       // px
uniform vec2 uCenter;     // of the glow, px from the bottom left
uniform vec3 uColors[3];  // from there outwards

out vec4 fragColor;

void main() {
  float r = length((gl_FragCoord.xy - uCenter) / (0.78 * uSize));
  vec3 color = mix(uColors[0], uColors[1], smoothstep(0.0, 0.5, r));
  color = mix(color, uColors[2], smoothstep(0.4, 1.0, r));
  // Interleaved gradient noise (Jimenez 2014), ± half a step of 8 bits.
  float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  fragColor = vec4(color + (noise - 0.5) / 255.0, 1.0);
}
