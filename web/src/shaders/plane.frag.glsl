// A pane of glass with a rim to hold it by, premultiplied.
precision highp float;

in vec2 vDisc;
uniform vec3 uColor;
uniform float uRim;      // radius of the rim
uniform float uPixel;    // size of a pixel in the disc's frame
uniform float uHover;    // 0…1: the rim is under the pointer
out vec4 fragColor;

float line(float distance, float width) {
  return 1.0 - smoothstep(0.5 * width, 0.5 * width + uPixel, abs(distance));
}

void main() {
  float r = length(vDisc);
  float inside = 1.0 - smoothstep(uRim - uPixel, uRim, r);
  float rim = line(r - uRim, (2.0 + 1.5 * uHover) * uPixel);
  float glow = exp(-abs(r - uRim) / (0.012 + 0.012 * uHover)) * (0.22 + 0.3 * uHover);
  float angle = atan(vDisc.y, vDisc.x) * 36.0 / 3.14159265;
  float nearest = abs(fract(angle + 0.5) - 0.5) / 36.0 * 3.14159265 * r;
  float tick = line(nearest, uPixel) * step(uRim - 0.035, r) * step(r, uRim);
  float alpha = clamp(0.045 * inside + 0.85 * rim + glow + 0.35 * tick, 0.0, 1.0);
  fragColor = vec4(uColor * alpha, alpha);
}
