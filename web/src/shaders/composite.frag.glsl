// The splats' picture with opaque faces, premultiplied and possibly brighter than its alpha, behind the faces that
// are not opaque, onto the page. Straight alpha where kStraight is set: what `clipgs render` writes.
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler3D;

#if kOutlined == 1
#include "outline.glsl"

uniform bool uHasOutline;
uniform Outline uOutline;
uniform int uOutlineRays;  // a pixel
uniform vec4 uOutlineRamps;
uniform sampler3D uValues;
uniform sampler3D uBlocks;
uniform sampler2D uMaterials;
uniform vec4 uPlanes[kMaxPlanes];
uniform int uPlaneCount;
uniform float uGrey;
#else
const int kMaxPlanes = 6;
#endif

uniform sampler2D uPicture;
uniform sampler2D uFaces;
uniform vec2 uTexelsPerPixel;  // of both, where they are drawn at another size

// Planes that are seen along themselves end the picture: the twin of KeptShare in src/splat/kept_share.h.
uniform vec4 uEdges[kMaxPlanes];  // what a plane keeps of a pixel at depth z: xyz·(x, y, 1) + w/z
uniform int uEdgeCount;
// Planes around the body, across some directions, at depths between two ends over xyz·(x, y, 1).
uniform vec3 uHull[kHullDirections];
uniform vec2 uHullEnds[kHullDirections];
uniform float uNear;
uniform float uMargin;  // of a depth, that splats reach out of the hull of their means

out vec4 fragColor;

// How much of a pixel, which counts from the top left, sees anything that is kept.
float keptShare(vec3 pixel) {
  if (uEdgeCount == 0) {
    return 1.0;
  }
  float near = uNear;
  float far = 1e30;
  for (int k = 0; k < kHullDirections; ++k) {
    float along = dot(uHull[k], pixel);
    if (abs(along) > 1e-6) {
      vec2 ends = uHullEnds[k] / along;
      near = max(near, min(ends.x, ends.y));
      far = min(far, max(ends.x, ends.y));
    }
  }
  near *= 1.0 - uMargin;
  far = max(far * (1.0 + uMargin), uNear);
  float share = 1.0;
  for (int i = 0; i < uEdgeCount; ++i) {
    float kept = dot(uEdges[i].xyz, pixel) + max(uEdges[i].w / near, uEdges[i].w / far);
    share *= clamp(kept + 0.5, 0.0, 1.0);
  }
  return share;
}

// What covers a pixel in part covers the same part of it: the twin of put_behind() in src/splat/behind.h.
vec4 putBehind(vec4 face, vec4 splats) {
  float seen = splats.a > face.a ? (splats.a - face.a) / splats.a : 0.0;
  return vec4(face.rgb + seen * splats.rgb, max(face.a, splats.a));
}

void main() {
  vec2 at = gl_FragCoord.xy * uTexelsPerPixel;
  vec2 size = vec2(textureSize(uPicture, 0));
  float kept = keptShare(vec3(vec2(at.x, 1.0 - at.y) * size - 0.5, 1.0));
  vec4 c = putBehind(texture(uFaces, at), kept * texture(uPicture, at));
  c.rgb = min(c.rgb, c.a);
#if kOutlined == 1
  // Colours are kept: of what faces leave, the splats'.
  float share = uHasOutline ? outlineShare(c.a, uOutlineRamps) : 0.0;
  if (share > 0.0) {
    vec4 face = texture(uFaces, at);
    vec2 pixel = vec2(gl_FragCoord.x, 1.0 / uTexelsPerPixel.y - gl_FragCoord.y) - 0.5;
    float covered = mix(c.a, matterOf(pixel, uTexelsPerPixel, uOutlineRays, uOutline, uValues, uBlocks, uMaterials, uPlanes,
                                      uPlaneCount), share);
    covered = uGrey > 0.0 ? max(face.a, covered) : covered;
    float beyond = c.a - face.a;  // that splats cover
    vec3 color = beyond >= kLeastBeyond ? clamp((c.rgb - face.rgb) / beyond, 0.0, 1.0) : face.rgb / face.a;
    vec3 light = covered > face.a ? face.rgb + (covered - face.a) * color : covered / face.a * face.rgb;
    c = vec4(light, covered);
  }
#endif
  if (kStraight == 1) {
    c.rgb /= max(c.a, 1e-6);
  }
  fragColor = c;
}
