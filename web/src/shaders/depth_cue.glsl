// What lies behind the case, and how what is far away fades towards it.

struct Backdrop {
  bool isGlow;   // else a gradient from `inner`, at the top, to `outer`, at the bottom
  vec2 size;     // of the picture, px
  vec2 center;   // of the glow, px from the bottom left
  vec3 inner;    // of the glow, from its middle outwards
  vec3 middle;
  vec3 outer;
};

struct DepthCue {
  float strength;  // 0: nothing fades … 1: what is farthest has gone
  vec3 center;     // of a sphere around what is visible
  float radius;
  bool covering;   // instead of colours, how much is left of what covers the picture
};

// At a pixel, px from the bottom left; display sRGB.
vec3 backdropAt(vec2 pixel, Backdrop b) {
  if (!b.isGlow) {
    return mix(b.outer, b.inner, pixel.y / b.size.y);
  }
  float r = length((pixel - b.center) / (0.78 * b.size));
  vec3 color = mix(b.inner, b.middle, smoothstep(0.0, 0.5, r));
  return mix(color, b.outer, smoothstep(0.4, 1.0, r));
}

// The share that is left of what lies at a point: the twin of DepthCue::kept() in src/core/depth_cue.h.
float keptOfDepth(vec3 point, vec3 eye, DepthCue cue) {
  float away = length(cue.center - eye);
  float near = max(0.0, away - cue.radius);
  return 1.0 - cue.strength * smoothstep(near, max(near + 1e-6, away + cue.radius), length(point - eye));
}

// A straight colour at a point, seen at a pixel (px from the bottom left).
vec3 cued(vec3 color, vec3 point, vec3 eye, vec2 pixel, DepthCue cue, Backdrop backdrop) {
  if (cue.strength == 0.0) {
    return color;
  }
  float kept = keptOfDepth(point, eye, cue);
  return cue.covering ? vec3(kept) : mix(backdropAt(pixel, backdrop), color, kept);
}
