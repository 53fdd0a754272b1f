// One triangle a Gaussian, kSplatsPerInstance of them an instance, far to near.
precision highp float;
precision highp int;
precision highp usampler2D;

#include "depth_cue.glsl"
#include "gaussian.glsl"
#include "packed.glsl"

in vec3 position;  // a corner of the triangle around the unit circle, and the number of the splat within its instance

uniform usampler2D uScene;
uniform usampler2D uOrder;
uniform usampler2D uColors;  // packed
uniform uint uCount;
uniform PackedScene uPackedScene;
uniform Camera uCamera;
uniform DepthCue uCue;
uniform Backdrop uBackdrop;
uniform vec2 uDepthToClip;  // clip z = x·depth + y, clip w = depth
uniform vec4 uPlanes[kPlanes];
uniform int uPlaneCount;
uniform int uSlabs;
uniform int uClip;
uniform usampler2D uLayers;  // of every splat
uniform int uSlab;           // the layer that the plane cuts …
uniform int uLayerSign;      // … beyond which, where sign·(layer − slab) > 0, layers are off
uniform float uExtent;  // sigmas that are drawn at most
uniform float uPixel;   // side of one that is drawn, in those of the picture

out vec2 vPosition;  // pixel offset in sigma along the splat's axes
out float vPlane[kPlanes];  // standardised distances of planes
flat out vec4 vColor;

// Of a splat by its number, in textures that are a power of two wide.
ivec2 texelOf(uint index) {
  return ivec2(index & ((1u << kWidthBits) - 1u), index >> kWidthBits);
}

void main() {
  gl_Position = vec4(0.0, 0.0, 2.0, 1.0);  // outside: nothing is drawn
  vPosition = vec2(0.0);
  for (int i = 0; i < kPlanes; ++i) {
    vPlane[i] = kUncut;
  }
  vColor = vec4(0.0);
  uint index = uint(gl_InstanceID) * uint(kSplatsPerInstance) + uint(position.z);
  if (index >= uCount) {
    return;
  }
  ivec2 texel = texelOf(texelFetch(uOrder, texelOf(index), 0).r);
  Gaussian g = unpackGaussian(texelFetch(uScene, texel, 0), uPackedScene);
  int clip = uClip;
  if (uClip == kClipLayers) {
    int beyond = uLayerSign * (int(texelFetch(uLayers, texel, 0).r) - uSlab);
    if (beyond > 0) {
      return;
    }
    clip = beyond == 0 ? kClipExact : kClipNone;
  }
  Splat s = project(g, uCamera, uPlanes, uPlaneCount, uSlabs, clip);
  if (!s.visible) {
    return;
  }
  vec2 corner = position.xy * min(s.reach, uExtent);
  vec2 offset = corner.x * s.sigma.x * s.axis + corner.y * s.sigma.y * vec2(-s.axis.y, s.axis.x);
  vPosition = corner;
  for (int i = 0; i < kPlanes; ++i) {
    vPlane[i] = s.z[i] + dot(s.slope[i], offset);
  }
  vec3 color = unpackColor(texelFetch(uColors, texel, 0).r);
  vec2 pixel = uPixel * vec2(s.center.x, uCamera.size.y - s.center.y);
  vColor = vec4(cued(color, g.mean, uCamera.position, pixel, uCue, uBackdrop), s.opacity);
  vec2 ndc = 2.0 * (s.center + offset) / uCamera.size - 1.0;
  gl_Position = vec4(ndc.x, -ndc.y, (uDepthToClip.x * s.depth + uDepthToClip.y) / s.depth, 1.0);
}
