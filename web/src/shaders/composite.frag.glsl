// The splats' picture with opaque faces, premultiplied and possibly brighter than its alpha, behind the faces that
// are not opaque, onto the page. Straight alpha where kStraight is set: what `clipgs render` writes. Where kSolid is set,
// with a depth, so that hands can be before and behind it.
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler3D;

#include "behind.glsl"

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
uniform bool uHasSurface;
uniform sampler2D uSurface;      // as surface.frag.glsl draws it, and
uniform sampler2D uTintSplats;   // as tint.frag.glsl does
uniform sampler2D uTintSurface;
uniform float uTintBlock;        // pixels
#else
const int kMaxPlanes = 6;
#endif

uniform sampler2D uPicture;
uniform sampler2D uSplats;     // where they are coarse, and uPicture has opaque faces alone
uniform bool uIsCoarse;
uniform sampler2D uFaces;
uniform vec2 uSize;            // of the picture and the faces, px
uniform vec2 uTexelsPerPixel;  // of both, where they are drawn at another size
uniform vec2 uCorner;          // px: where the picture begins in what is drawn into
#if kSolid == 1
uniform sampler2D uDepth;         // of opaque faces
uniform sampler2D uSurfaceDepth;  // of those and, where there is a surface, of that
uniform float uMiddleDepth;       // of all else that is seen: as if it were in the body's middle
uniform vec3 uFaceDepths[kMaxFaces];  // of planes: the z of a place (x, y) of the eye's, xyz·(x, y, 1)
uniform int uFaceCount;
const float kFace = 0.001;  // faces are drawn nearer than this, wherever they are

float faceDepth(vec2 at) {
  float z = -1.0;
  for (int i = 0; i < uFaceCount; ++i) {
    z = max(z, dot(uFaceDepths[i], vec3(2.0 * at - 1.0, 1.0)));
  }
  return 0.5 + 0.5 * z;
}
uniform bool uToLinear;  // into a picture of linear light
#endif

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

#if kOutlined == 1
const float kBelief = 0.1;  // how much of the surface's own colour is believed beside the splats'
const float kMostTint = 1.25;  // light that a cut lets in makes splats of what was dark far too bright
const float kLeastSurface = 0.125;  // half a ray of four: less is what a filter spreads

// A block's mean around a pixel from the top left: four samples half a block beside it.
vec3 aroundPixel(vec2 pixel, sampler2D means) {
  vec2 blocks = vec2(textureSize(means, 0));
  vec2 at = pixel / uTintBlock;
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 4; ++i) {
    sum += texture(means, (at + vec2(i & 1, i >> 1) - 0.5) / blocks).rgb;
  }
  return 0.25 * sum;
}

// The surface as splats tint it: the twin of tinted() in src/section/tint.h.
vec3 tinted(vec4 surface, vec2 pixel) {
  vec3 ratio = (aroundPixel(pixel, uTintSplats) + kBelief) / (aroundPixel(pixel, uTintSurface) + kBelief);
  return min(surface.rgb / surface.a * min(ratio, kMostTint), 1.0);
}
#endif

void main() {
  vec2 fromCorner = gl_FragCoord.xy - uCorner;
  vec2 at = fromCorner * uTexelsPerPixel;
  vec4 c = texture(uPicture, at);
  if (uIsCoarse && c.a == 0.0) {
    c = texture(uSplats, at);
  }
  if (c.a > 0.0) {
    c *= keptShare(vec3(vec2(at.x, 1.0 - at.y) * uSize - 0.5, 1.0));
  }
  vec4 face = texture(uFaces, at);
  c = putBehind(face, c);
  c.rgb = min(c.rgb, c.a);
#if kOutlined == 1
  // Of what faces leave, the colour is the surface's where there is one, and else the splats'.
  vec4 surface = uHasSurface ? texture(uSurface, at) : vec4(0.0);
  bool onSurface = surface.a > kLeastSurface;
  float share = uHasOutline ? outlineShare(onSurface ? max(c.a, uOutlineRamps.y) : c.a, uOutlineRamps) : 0.0;
  if (share > 0.0 || onSurface) {
    vec2 pixel = vec2(fromCorner.x, 1.0 / uTexelsPerPixel.y - fromCorner.y) - 0.5;
    float covered = c.a;
    if (share > 0.0) {
      covered = mix(c.a, matterOf(pixel, uTexelsPerPixel, uOutlineRays, uOutline, uValues, uBlocks, uMaterials, uPlanes,
                                  uPlaneCount), share);
    }
    covered = uGrey > 0.0 ? max(face.a, covered) : covered;
    float beyond = c.a - face.a;  // that splats cover
    vec3 color = beyond >= kLeastBeyond ? clamp((c.rgb - face.rgb) / beyond, 0.0, 1.0) : face.rgb / max(face.a, 1e-6);
    if (onSurface) {
      float seen = beyond >= kLeastBeyond ? min(2.0 * surface.a, 1.0) : 1.0;
      color = mix(color, tinted(surface, vec2(at.x, 1.0 - at.y) * uSize), seen);
    }
    vec3 light = covered > face.a ? face.rgb + (covered - face.a) * color : covered / max(face.a, 1e-6) * face.rgb;
    c = vec4(light, covered);
  }
#endif
#if kSolid == 1
  float depth = texture(uDepth, at).r;
#if kOutlined == 1
  depth = uHasSurface ? texture(uSurfaceDepth, at).r : depth;
#endif
  depth = depth < kFace ? faceDepth(at) : depth < 1.0 ? depth : uMiddleDepth;
  gl_FragDepth = c.a < 0.5 ? 1.0 : depth;
  if (uToLinear && c.a > 0.0) {
    vec3 s = clamp(c.rgb / c.a, 0.0, 1.0);
    c.rgb = c.a * mix(s / 12.92, pow((s + 0.055) / 1.055, vec3(2.4)), step(0.04045, s));
  }
#endif
  if (kStraight == 1) {
    c.rgb /= max(c.a, 1e-6);
  }
  fragColor = c;
}
