// How a Gaussian lies in a texel of the scene texture (RGBA32UI, 16 bytes), the bytes of SOG unchanged:
//   x  mean.x u16 | mean.y u16 << 16
//   y  mean.z u16 | SH label u16 << 16
//   z  quaternion bytes a, b, c | largest component << 24
//   w  scale codebook index x, y, z | opacity u8 << 24

struct PackedScene {
  vec3 meanMin;   // in SOG's logarithmic domain
  vec3 meanSize;
};

Gaussian unpackGaussian(uvec4 p, PackedScene scene, highp sampler2D scaleCodebook) {
  Gaussian g;
  vec3 mean = vec3(p.x & 0xffffu, p.x >> 16, p.y & 0xffffu) / 65535.0;
  g.mean = sogMean(scene.meanMin + scene.meanSize * mean);
  vec3 bytes = vec3(p.z & 255u, (p.z >> 8) & 255u, (p.z >> 16) & 255u);
  mat3 r = rotationMatrix(sogQuaternion(bytes, int(p.z >> 24)));
  g.axes = mat3(r[0] * texelFetch(scaleCodebook, ivec2(p.w & 255u, 0), 0).r,
                r[1] * texelFetch(scaleCodebook, ivec2((p.w >> 8) & 255u, 0), 0).r,
                r[2] * texelFetch(scaleCodebook, ivec2((p.w >> 16) & 255u, 0), 0).r);
  g.opacity = float(p.w >> 24) / 255.0;
  return g;
}

uint shLabel(uvec4 p) { return p.y >> 16; }
