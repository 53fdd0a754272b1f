// One quad a Gaussian, kQuadsPerInstance of them an instance, far to near.
precision highp float;
precision highp int;
precision highp usampler2D;
precision highp sampler2D;

#include "gaussian.glsl"
#include "packed.glsl"

in vec3 position;  // corner (±1, ±1) and the number of the quad within its instance

uniform usampler2D uScene;
uniform usampler2D uOrder;
uniform sampler2D uColors;
uniform usampler2D uFaceLabels;    // palette entry of every splat
uniform sampler2D uFacePalette;    // kFaceCoefficients texels an entry, 64 entries a row
uniform bool uHasFaceColors;
uniform sampler2D uScaleCodebook;
uniform uint uCount;
uniform PackedScene uPackedScene;
uniform Camera uCamera;
uniform vec2 uDepthToClip;  // clip z = x·depth + y, clip w = depth
uniform vec4 uPlanes[kPlanes];
uniform vec3 uGains[kPlanes];
uniform int uPlaneCount;
uniform int uSlabs;
uniform int uClip;
uniform float uExtent;  // sigmas that are drawn at most

// The sum of SH of degree 1 in the normal n of a plane: what its cut adds to a splat's colour.
vec3 faceColor(int label, vec3 n) {
  ivec2 first = ivec2((label % 64) * 4, label / 64);
  vec3 c[4];
  for (int k = 0; k < 4; ++k) {
    c[k] = texelFetch(uFacePalette, first + ivec2(k, 0), 0).rgb;
  }
  return 0.28209479177387814 * c[0] + 0.4886025119029199 * (n.z * c[2] - n.y * c[1] - n.x * c[3]);
}

out vec2 vPosition;  // pixel offset in sigma along the splat's axes
out float vPlane[kPlanes];  // standardised distances of planes
flat out vec4 vColor;

void main() {
  gl_Position = vec4(0.0, 0.0, 2.0, 1.0);  // outside: nothing is drawn
  vPosition = vec2(0.0);
  for (int i = 0; i < kPlanes; ++i) {
    vPlane[i] = kUncut;
  }
  vColor = vec4(0.0);
  uint index = uint(gl_InstanceID) * uint(kQuadsPerInstance) + uint(position.z);
  if (index >= uCount) {
    return;
  }
  ivec2 orderSize = textureSize(uOrder, 0);
  uint id = texelFetch(uOrder, ivec2(int(index) % orderSize.x, int(index) / orderSize.x), 0).r;
  int width = textureSize(uScene, 0).x;
  ivec2 texel = ivec2(int(id) % width, int(id) / width);
  Gaussian g = unpackGaussian(texelFetch(uScene, texel, 0), uPackedScene, uScaleCodebook);
  Splat s = project(g, uCamera, uPlanes, uPlaneCount, uSlabs, uClip);
  if (!s.visible) {
    return;
  }
  vec2 corner = position.xy * min(s.reach, uExtent);
  vec2 offset = corner.x * s.sigma.x * s.axis + corner.y * s.sigma.y * vec2(-s.axis.y, s.axis.x);
  vPosition = corner;
  for (int i = 0; i < kPlanes; ++i) {
    vPlane[i] = s.z[i] + dot(s.slope[i], offset);
  }
  vec3 color = texelFetch(uColors, texel, 0).rgb;
  vec3 gain = vec3(1.0);
  for (int i = 0; i < kPlanes; ++i) {
    if (s.face[i] > 0.0) {
      gain *= mix(vec3(1.0), uGains[i], s.face[i]);
      if (uHasFaceColors) {
        color += s.face[i] * faceColor(int(texelFetch(uFaceLabels, texel, 0).r), uPlanes[i].xyz);
      }
    }
  }
  vColor = vec4(gain * max(color, 0.0), s.opacity);
  vec2 ndc = 2.0 * (s.center + offset) / uCamera.size - 1.0;
  gl_Position = vec4(ndc.x, -ndc.y, (uDepthToClip.x * s.depth + uDepthToClip.y) / s.depth, 1.0);
}
