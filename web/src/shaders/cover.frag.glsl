// Keeps splats away, by its depth, from coarse pixels that show nothing of them: all that is interpolated from one of those
// lies beneath opaque faces.
precision highp float;
precision highp int;
precision highp sampler2D;

uniform sampler2D uDepth;  // less than 1 where there is an opaque face
uniform vec2 uPixel;       // size of a coarse one, px

out vec4 fragColor;

void main() {
  ivec2 last = textureSize(uDepth, 0) - 1;
  ivec2 first = ivec2(floor((gl_FragCoord.xy - 1.0) * uPixel));
  ivec2 count = ivec2(ceil(2.0 * uPixel));
  float farthest = 0.0;
  for (int y = 0; y < count.y; ++y) {
    for (int x = 0; x < count.x; ++x) {
      farthest = max(farthest, texelFetch(uDepth, clamp(first + ivec2(x, y), ivec2(0), last), 0).r);
    }
  }
  gl_FragDepth = farthest;
  fragColor = vec4(0.0);
}
