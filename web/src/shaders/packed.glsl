// How a Gaussian lies in a texel of the scene texture (RGBA32UI, 16 bytes), the bytes of SOG unchanged:
//   x  mean.x u16 | mean.y u16 << 16
//   y  mean.z u16 | SH label u16 << 16
//   z  quaternion bytes a, b, c | largest component << 24
//   w  scale codebook index x, y, z | opacity u8 << 24

struct PackedScene {
  vec3 meanMin;   // in SOG's logarithmic domain
  vec3 meanSize;
};

uniform vec4 uScaleCodebook[64];  // 256 standard deviations; not a texture, which would be read for every corner

float codebookScale(uint index) {
  return uScaleCodebook[index >> 2][index & 3u];
}

vec3 unpackScale(uvec4 p) {
  return vec3(codebookScale(p.w & 255u), codebookScale((p.w >> 8) & 255u), codebookScale((p.w >> 16) & 255u));
}

Gaussian unpackGaussian(uvec4 p, PackedScene scene) {
  Gaussian g;
  vec3 mean = vec3(p.x & 0xffffu, p.x >> 16, p.y & 0xffffu) / 65535.0;
  g.mean = sogMean(scene.meanMin + scene.meanSize * mean);
  vec3 bytes = vec3(p.z & 255u, (p.z >> 8) & 255u, (p.z >> 16) & 255u);
  mat3 r = rotationMatrix(sogQuaternion(bytes, int(p.z >> 24)));
  vec3 scale = unpackScale(p);
  g.axes = mat3(r[0] * scale.x, r[1] * scale.y, r[2] * scale.z);
  g.opacity = float(p.w >> 24) / 255.0;
  return g;
}

uint shLabel(uvec4 p) { return p.y >> 16; }

// The colour of a splat as seen now, from 0 to 4 in 4 bytes: 11, 11 and 10 bits.
const float kMaxColor = 4.0;

uint packColor(vec3 color) {
  uvec3 c = uvec3(clamp(color / kMaxColor, 0.0, 1.0) * vec3(2047.0, 2047.0, 1023.0) + 0.5);
  return c.r | c.g << 11 | c.b << 22;
}

vec3 unpackColor(uint c) {
  return kMaxColor * vec3(c & 2047u, (c >> 11) & 2047u, c >> 22) / vec3(2047.0, 2047.0, 1023.0);
}
