// What covers a pixel in part covers the same part of it: the twin of put_behind() in src/splat/behind.h.
vec4 putBehind(vec4 face, vec4 splats) {
  float seen = splats.a > face.a ? (splats.a - face.a) / splats.a : 0.0;
  return vec4(face.rgb + seen * splats.rgb, max(face.a, splats.a));
}
