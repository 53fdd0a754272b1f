// Means over blocks of pixels, rows from the picture's top: of the splats that lie on the volume's surface, and of that
// where there are splats (tinted() in src/section/tint.h).
precision highp float;
precision highp int;
precision highp sampler2D;

#include "behind.glsl"

uniform sampler2D uSplats;   // of a picture as large as that of the faces, or smaller
uniform sampler2D uFaces;
uniform sampler2D uSurface;  // premultiplied; likewise
uniform int uBlock;          // px of the faces
uniform int uStep;           // every so many of them are looked at, across and down

layout(location = 0) out vec4 fragSplats;
layout(location = 1) out vec4 fragSurface;

void main() {
  ivec2 size = textureSize(uFaces, 0);
  vec2 toSplats = vec2(textureSize(uSplats, 0)) / vec2(size);
  vec2 toSurface = vec2(textureSize(uSurface, 0)) / vec2(size);
  ivec2 first = ivec2(gl_FragCoord.xy) * uBlock;
  ivec2 end = min(first + uBlock, size);
  vec3 splats = vec3(0.0);
  vec3 surface = vec3(0.0);
  for (int y = first.y; y < end.y; y += uStep) {
    for (int x = first.x; x < end.x; x += uStep) {
      ivec2 at = ivec2(x, size.y - 1 - y);
      vec2 middle = vec2(at) + 0.5;
      vec4 seen = texelFetch(uSurface, ivec2(middle * toSurface), 0);
      if (seen.a > 0.0) {
        vec4 face = texelFetch(uFaces, at, 0);
        vec4 all = putBehind(face, texelFetch(uSplats, ivec2(middle * toSplats), 0));
        vec4 beyond = max(vec4(min(all.rgb, all.a), all.a) - face, 0.0);
        splats += seen.a * beyond.rgb;
        surface += beyond.a * seen.rgb;
      }
    }
  }
  int across = (uBlock + uStep - 1) / uStep;
  float pixels = float(across * across);
  fragSplats = vec4(splats / pixels, 1.0);
  fragSurface = vec4(surface / pixels, 1.0);
}
