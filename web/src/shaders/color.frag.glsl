// The colour of every Gaussian as seen from one point, one texel each: 0.5 + Σ Yₖ·cₖ, and what planes change at their
// faces. Runs when camera or planes move, not for every corner of every splat.
precision highp float;
precision highp int;
precision highp usampler2D;
precision highp sampler2D;
precision highp sampler3D;

#include "gaussian.glsl"
#include "packed.glsl"
#include "relight.glsl"
#include "spherical_harmonics.glsl"

uniform usampler2D uScene;
uniform usampler2D uSh0;         // codebook indices of the constant terms
uniform usampler2D uCentroids;   // codebook indices of the higher terms, 64 palette entries a row
uniform sampler2D uSh0Codebook;
uniform sampler2D uShNCodebook;
uniform int uShCoefficients;     // of the higher terms: 0, 3, 8 or 15
uniform PackedScene uPackedScene;
uniform vec3 uEye;
uniform usampler2D uFaceLabels;  // palette entry of every splat
uniform sampler2D uFacePalette;  // kFaceCoefficients texels an entry, 64 entries a row
uniform bool uHasFaceColors;
uniform vec4 uPlanes[kMaxPlanes];
uniform vec3 uGains[kMaxPlanes];
uniform int uPlaneCount;
uniform SplatLight uSplatLight;
uniform highp sampler3D uLight;
uniform highp sampler3D uOwnLight;

out uint fragColor;

vec3 lookUp(sampler2D codebook, uvec3 index) {
  return vec3(texelFetch(codebook, ivec2(index.r, 0), 0).r, texelFetch(codebook, ivec2(index.g, 0), 0).r,
              texelFetch(codebook, ivec2(index.b, 0), 0).r);
}

// The sum of SH of degree 1 in the normal n of a plane: what its cut adds to a splat's colour.
vec3 faceColor(int label, vec3 n) {
  ivec2 first = ivec2((label % 64) * 4, label / 64);
  vec3 c[4];
  for (int k = 0; k < 4; ++k) {
    c[k] = texelFetch(uFacePalette, first + ivec2(k, 0), 0).rgb;
  }
  return 0.28209479177387814 * c[0] + 0.4886025119029199 * (n.z * c[2] - n.y * c[1] - n.x * c[3]);
}

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  uvec4 p = texelFetch(uScene, texel, 0);
  float basis[kMaxShCoefficients];
  Gaussian g = unpackGaussian(p, uPackedScene);
  shBasis(normalize(g.mean - uEye), basis);
  vec3 meanColor = 0.5 + basis[0] * lookUp(uSh0Codebook, texelFetch(uSh0, texel, 0).rgb);
  vec3 color = meanColor;
  int label = int(shLabel(p));
  ivec2 first = ivec2((label % 64) * uShCoefficients, label / 64);
  for (int k = 0; k < uShCoefficients; ++k) {
    color += basis[k + 1] * lookUp(uShNCodebook, texelFetch(uCentroids, first + ivec2(k, 0), 0).rgb);
  }
  vec3 gain = vec3(1.0);
  if (uSplatLight.changed) {
    vec3 s = unpackScale(p);
    int shortest = s.x <= s.y && s.x <= s.z ? 0 : (s.y <= s.z ? 1 : 2);
    vec3 changed = lightGain(g.mean, g.axes[shortest], uSplatLight, uLight, uOwnLight);
    color = displayGain(changed, meanColor, uSplatLight.filmic) * max(color, 0.0);
  }
  for (int i = 0; i < uPlaneCount; ++i) {
    float share = faceShare(g, uPlanes[i], uEye);
    if (share > 0.0) {
      gain *= mix(vec3(1.0), uGains[i], share);
      if (uHasFaceColors) {
        color += share * faceColor(int(texelFetch(uFaceLabels, texel, 0).r), uPlanes[i].xyz);
      }
    }
  }
  fragColor = packColor(gain * max(color, 0.0));
}
