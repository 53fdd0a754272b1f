// The colour of every Gaussian as seen from one point, one texel each: 0.5 + Σ Yₖ·cₖ.
// Runs when the camera moves, not for every corner of every quad.
precision highp float;
precision highp int;
precision highp usampler2D;
precision highp sampler2D;

#include "gaussian.glsl"
#include "packed.glsl"
#include "spherical_harmonics.glsl"

uniform usampler2D uScene;
uniform usampler2D uSh0;         // codebook indices of the constant terms
uniform usampler2D uCentroids;   // codebook indices of the higher terms, 64 palette entries a row
uniform sampler2D uSh0Codebook;
uniform sampler2D uShNCodebook;
uniform int uShCoefficients;     // of the higher terms: 0, 3, 8 or 15
uniform PackedScene uPackedScene;
uniform vec3 uEye;

out vec4 fragColor;

vec3 lookUp(sampler2D codebook, uvec3 index) {
  return vec3(texelFetch(codebook, ivec2(index.r, 0), 0).r, texelFetch(codebook, ivec2(index.g, 0), 0).r,
              texelFetch(codebook, ivec2(index.b, 0), 0).r);
}

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  uvec4 p = texelFetch(uScene, texel, 0);
  float basis[kMaxShCoefficients];
  vec3 mean = vec3(p.x & 0xffffu, p.x >> 16, p.y & 0xffffu) / 65535.0;
  mean = sogMean(uPackedScene.meanMin + uPackedScene.meanSize * mean);
  shBasis(normalize(mean - uEye), basis);
  vec3 color = 0.5 + basis[0] * lookUp(uSh0Codebook, texelFetch(uSh0, texel, 0).rgb);
  int label = int(shLabel(p));
  ivec2 first = ivec2((label % 64) * uShCoefficients, label / 64);
  for (int k = 0; k < uShCoefficients; ++k) {
    color += basis[k + 1] * lookUp(uShNCodebook, texelFetch(uCentroids, first + ivec2(k, 0), 0).rgb);
  }
  fragColor = vec4(color, 1.0);
}
