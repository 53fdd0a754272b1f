// The mathematics of splatting one Gaussian, as docs/method.md writes it down: decoding, EWA projection
// and the clip operators. Functions of their arguments only, so that any GLSL program can include
// this text. Its C++ twin is src/splat/projection.cpp with src/splat/clip.h.
//
// Scene space is that of the case file. Camera axes are x right, y down, z forward; image coordinates
// are px from the top left.

#ifndef kPlanes  // the most that an including program draws with
#define kPlanes 1
#endif

const float kBlurVariance = 0.1;            // px², about that of a pixel's area
const float kAlphaMin = 1.0 / 255.0;        // fainter contributions are skipped
const float kAlphaMax = 0.99;               // opacity of one Gaussian at one pixel
const float kClipSigma = 3.0;               // further from the plane nothing is cut
const float kCdfLinear = 1.5976;
const float kCdfCubic = 0.07056;
const float kMinConditionalVariance = 1e-6;
const float kFaceWhole = 1.5;               // s_n below a plane down to which a splat lies at its face wholly
const float kFaceNone = 3.0;                // … and from which on not at all
const float kFacing = 0.03;                 // cosine of n and the view from which on a face is seen wholly
const float kUncut = 30.0;                  // a plane distance in s at which Φ is 1

const int kClipNone = 0;
const int kClipHard = 1;
const int kClipSoft = 2;
const int kClipExact = 3;
const int kClipLayers = 4;  // of a splat by its layer: whole, by kClipExact, or not at all

struct Gaussian {
  vec3 mean;
  mat3 axes;      // R·S: columns are the local axes times their standard deviations
  float opacity;
};

struct Camera {
  mat3 rotation;  // scene → camera
  vec3 position;  // scene space
  vec2 focal;     // px
  vec2 principal; // px
  vec2 size;      // px
  float near;     // scene units
};

// What a pixel needs. With δ = pixel − center: α = min(kAlphaMax, opacity·keptShare(z + slope·δ)·G(δ)),
// G(δ) = exp(−½ δᵀΣ₂⁻¹δ), where Σ₂ has the eigenvectors axis, axis⊥ and standard deviations sigma.
struct Splat {
  bool visible;
  vec2 center;
  float depth;
  vec2 axis;
  vec2 sigma;     // px
  float reach;    // beyond this many sigma α < kAlphaMin
  float opacity;
  float z[kPlanes];
  vec2 slope[kPlanes];
};

// Decodes a coordinate of SOG: v = sign(x)·ln(|x| + 1).
vec3 sogMean(vec3 v) { return sign(v) * (exp(abs(v)) - 1.0); }

// Decodes a quaternion of SOG: the three smallest components as bytes, and which one is left out.
// Returns (w, x, y, z).
vec4 sogQuaternion(vec3 bytes, int largest) {
  vec3 c = (bytes / 255.0 - 0.5) * 1.41421356;
  float m = sqrt(max(0.0, 1.0 - dot(c, c)));
  if (largest == 0) return vec4(m, c);
  if (largest == 1) return vec4(c.x, m, c.yz);
  if (largest == 2) return vec4(c.xy, m, c.z);
  return vec4(c, m);
}

mat3 rotationMatrix(vec4 q) {
  float w = q.x, x = q.y, y = q.z, z = q.w;
  return mat3(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y),
              2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x),
              2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y));
}

// Φ, the normal distribution function, error below 1.5e-4.
float normalCdf(float x) {
  return 1.0 / (1.0 + exp(-x * (kCdfLinear + kCdfCubic * x * x)));
}

// What planes leave together that leave these shares each. The slabs' bit of a plane says that it is opposite to the
// one before: the two leave what is between them.
float jointShare(float shares[kPlanes], int slabs) {
  float product = 1.0;
  float last = shares[0];
  for (int i = 1; i < kPlanes; ++i) {
    bool slab = ((slabs >> i) & 1) == 1;
    product *= slab ? 1.0 : last;
    last = slab ? max(0.0, last + shares[i] - 1.0) : shares[i];
  }
  return product * last;
}

// What planes at standardised distances z leave of a Gaussian at a pixel.
float keptShare(float z[kPlanes], int slabs) {
  float shares[kPlanes];
  for (int i = 0; i < kPlanes; ++i) {
    shares[i] = z[i] < 6.0 ? normalCdf(z[i]) : 1.0;  // Φ(6) differs from 1 by less than a float can tell
  }
  return jointShare(shares, slabs);
}

// Whether a Gaussian lies at the face of a plane that is seen from `eye`: 0 to 1.
float faceShare(Gaussian g, vec4 plane, vec3 eye) {
  float distance = dot(plane.xyz, g.mean) - plane.w;
  return (1.0 - smoothstep(kFaceWhole, kFaceNone, distance / length(plane.xyz * g.axes))) *
         smoothstep(0.0, kFacing, dot(plane.xyz, normalize(g.mean - eye)));
}

// Planes keep dot(plane.xyz, x) − plane.w >= 0; what all of them keep is kept.
Splat project(Gaussian g, Camera camera, vec4 planes[kPlanes], int count, int slabs, int clip) {
  Splat s;
  s.visible = false;
  vec3 t = camera.rotation * (g.mean - camera.position);
  s.depth = t.z;
  bool removed = false;
  float d[kPlanes];
  float variance[kPlanes];                      // s_n² = nᵀΣn
  float deviation[kPlanes];
  vec3 local[kPlanes];                          // Mᵀn
  float shares[kPlanes];
  for (int i = 0; i < kPlanes; ++i) {
    d[i] = dot(planes[i].xyz, g.mean) - planes[i].w;
    local[i] = planes[i].xyz * g.axes;
    variance[i] = dot(local[i], local[i]);
    deviation[i] = sqrt(variance[i]);
    bool cuts = i < count;
    shares[i] = cuts && clip == kClipSoft ? clamp(0.5 + d[i] / (2.0 * deviation[i]), 0.0, 1.0) : 1.0;
    removed = removed || (cuts && clip == kClipHard && d[i] < 0.0) ||
              (cuts && clip == kClipExact && d[i] < -kClipSigma * deviation[i]);
  }
  s.opacity = g.opacity * jointShare(shares, slabs);
  if (removed || t.z <= camera.near || s.opacity < kAlphaMin) {
    return s;
  }

  // A = J·W, B = A·M, Σ₂ = B·Bᵀ + blur. The clamp is inside J only.
  vec2 limit = 1.3 * 0.5 * camera.size / camera.focal;
  vec2 l = clamp(t.xy / t.z, -limit, limit);
  vec3 w0 = vec3(camera.rotation[0].x, camera.rotation[1].x, camera.rotation[2].x);
  vec3 w1 = vec3(camera.rotation[0].y, camera.rotation[1].y, camera.rotation[2].y);
  vec3 w2 = vec3(camera.rotation[0].z, camera.rotation[1].z, camera.rotation[2].z);
  vec3 bx = ((camera.focal.x / t.z) * (w0 - l.x * w2)) * g.axes;
  vec3 by = ((camera.focal.y / t.z) * (w1 - l.y * w2)) * g.axes;
  float xx = dot(bx, bx) + kBlurVariance;
  float xy = dot(bx, by);
  float yy = dot(by, by) + kBlurVariance;
  vec3 across = cross(bx, by);  // |B·Bᵀ| = |bx × by|²: of needles xx·yy − xy² is what rounding leaves
  float det = dot(across, across) + kBlurVariance * (xx + yy - kBlurVariance);

  for (int i = 0; i < kPlanes; ++i) {
    s.z[i] = kUncut;
    s.slope[i] = vec2(0.0);
    if (clip == kClipExact && i < count && d[i] < kClipSigma * deviation[i]) {
      vec2 c = vec2(dot(bx, local[i]), dot(by, local[i]));            // A Σ n
      vec2 k = vec2(yy * c.x - xy * c.y, xx * c.y - xy * c.x) / det;  // Σ₂⁻¹ c
      float invS = inversesqrt(max(variance[i] - dot(c, k), kMinConditionalVariance * variance[i]));
      s.z[i] = d[i] * invS;
      s.slope[i] = k * invS;
    }
  }

  s.center = camera.focal * t.xy / t.z + camera.principal;
  s.reach = sqrt(2.0 * log(s.opacity / kAlphaMin));
  float mid = 0.5 * (xx + yy);
  float spread = sqrt(max(0.0, 0.25 * (xx - yy) * (xx - yy) + xy * xy));
  float major = mid + spread;
  s.sigma = sqrt(vec2(major, max(kBlurVariance, mid - spread)));
  vec2 axis = abs(xy) < 1e-6 * major ? (xx >= yy ? vec2(1.0, 0.0) : vec2(0.0, 1.0))
                                     : normalize(xx >= yy ? vec2(major - yy, xy) : vec2(xy, major - xx));
  s.axis = axis;

  // Half size of the box around the ellipse where α may reach kAlphaMin.
  vec2 extent = s.reach * sqrt(vec2(xx, yy));
  s.visible = all(greaterThanEqual(s.center + extent, vec2(0.0))) &&
              all(lessThanEqual(s.center - extent, camera.size));
  return s;
}
