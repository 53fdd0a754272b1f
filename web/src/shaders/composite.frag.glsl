// The splats' picture with opaque faces, premultiplied and possibly brighter than its alpha, behind the faces that
// are not opaque, onto the page. Straight alpha where kStraight is set: what `clipgs render` writes.
precision highp float;
precision highp sampler2D;

uniform sampler2D uPicture;
uniform sampler2D uFaces;
uniform vec2 uTexelsPerPixel;  // of both, where they are drawn at another size

out vec4 fragColor;

// What covers a pixel in part covers the same part of it: the twin of put_behind() in src/splat/behind.h.
vec4 putBehind(vec4 face, vec4 splats) {
  float seen = splats.a > face.a ? (splats.a - face.a) / splats.a : 0.0;
  return vec4(face.rgb + seen * splats.rgb, max(face.a, splats.a));
}

void main() {
  vec2 at = gl_FragCoord.xy * uTexelsPerPixel;
  vec4 c = putBehind(texture(uFaces, at), texture(uPicture, at));
  c.rgb = min(c.rgb, c.a);
  if (kStraight == 1) {
    c.rgb /= max(c.a, 1e-6);
  }
  fragColor = c;
}
