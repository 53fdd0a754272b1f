#include "splat/projection.h"

#include <algorithm>
#include <cmath>

#include "splat/clip.h"
#include "splat/sh.h"

namespace clipgs {

namespace {

/// Symmetric 2×2 matrix [xx xy; xy yy].
struct Sym2 {
  float xx, xy, yy;
  Vec2 operator*(const Vec2& v) const { return {xx * v.x + xy * v.y, xy * v.x + yy * v.y}; }
};

/// Two rows of three: maps 3-vectors to the image plane.
struct Rows {
  Vec3 x, y;
};

/// Everything between a Gaussian's parameters and its Splat that the backward pass needs again.
struct Projection {
  Vec3 t;                   // centre in camera space, mm
  float lx, ly;             // t.x/t.z and t.y/t.z, clamped as inside J
  bool inside_x, inside_y;  // whether that clamp was idle
  Quat q;                   // as stored
  float q_norm;
  Mat3 r;      // rotation, columns are the local axes
  Vec3 scale;  // mm
  Mat3 m;      // R·S
  Rows a;      // J·W
  Rows b;      // A·M
  Sym2 cov;    // Σ₂
  Sym2 conic;  // Σ₂⁻¹
};

Mat3 rotation_matrix(const Quat& q) {
  const float w = q.w, x = q.x, y = q.y, z = q.z;
  return {Vec3(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
          Vec3(2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
          Vec3(2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))};
}

/// Gradient with respect to the stored quaternion from that with respect to R (columns).
Quat rotation_backward(const Quat& stored, float norm, const Mat3& g) {
  const float w = stored.w / norm, x = stored.x / norm, y = stored.y / norm, z = stored.z / norm;
  const float gw =
      2 * (z * (g[0][1] - g[1][0]) + y * (g[2][0] - g[0][2]) + x * (g[1][2] - g[2][1]));
  const float gx = 2 * (y * (g[0][1] + g[1][0]) + z * (g[0][2] + g[2][0]) +
                        w * (g[1][2] - g[2][1]) - 2 * x * (g[1][1] + g[2][2]));
  const float gy = 2 * (x * (g[0][1] + g[1][0]) + z * (g[1][2] + g[2][1]) +
                        w * (g[2][0] - g[0][2]) - 2 * y * (g[0][0] + g[2][2]));
  const float gz = 2 * (x * (g[0][2] + g[2][0]) + y * (g[1][2] + g[2][1]) +
                        w * (g[0][1] - g[1][0]) - 2 * z * (g[0][0] + g[1][1]));
  const float radial = gw * w + gx * x + gy * y + gz * z;
  return {(gw - radial * w) / norm, (gx - radial * x) / norm, (gy - radial * y) / norm,
          (gz - radial * z) / norm};
}

bool in_front(const Vec3& t) { return t.z > kNearPlane; }

Projection project_geometry(const Gaussians& gaussians, size_t i, const Camera& camera,
                            const Vec3& t) {
  Projection p;
  p.t = t;
  const float limit_x = 1.3f * 0.5f * static_cast<float>(camera.width) / camera.fx;
  const float limit_y = 1.3f * 0.5f * static_cast<float>(camera.height) / camera.fy;
  const float ux = t.x / t.z;
  const float uy = t.y / t.z;
  p.lx = std::clamp(ux, -limit_x, limit_x);
  p.ly = std::clamp(uy, -limit_y, limit_y);
  p.inside_x = p.lx == ux;
  p.inside_y = p.ly == uy;

  p.q = Quat(gaussians.plane(6)[i], gaussians.plane(7)[i], gaussians.plane(8)[i],
             gaussians.plane(9)[i]);
  p.q_norm = std::max(1e-12f, glm::length(p.q));
  p.r = rotation_matrix(p.q / p.q_norm);
  p.scale = gaussians.scale(i);
  p.m = Mat3(p.r[0] * p.scale.x, p.r[1] * p.scale.y, p.r[2] * p.scale.z);

  // J is [fx/z 0 −fx·lx/z; 0 fy/z −fy·ly/z]; a glm matrix is indexed [column][row].
  const Mat3& w = camera.rotation;
  const Vec3 w0(w[0][0], w[1][0], w[2][0]);
  const Vec3 w1(w[0][1], w[1][1], w[2][1]);
  const Vec3 w2(w[0][2], w[1][2], w[2][2]);
  p.a.x = (camera.fx / t.z) * (w0 - p.lx * w2);
  p.a.y = (camera.fy / t.z) * (w1 - p.ly * w2);
  p.b.x = p.a.x * p.m;  // row vector times matrix
  p.b.y = p.a.y * p.m;
  const float bxx = glm::dot(p.b.x, p.b.x);
  const float byy = glm::dot(p.b.y, p.b.y);
  p.cov = {bxx + kBlurVariance, glm::dot(p.b.x, p.b.y), byy + kBlurVariance};
  // Of needles ΣxxΣyy − Σxy² would be what rounding leaves: |BBᵀ| = |b_x × b_y|² (Cauchy–Binet).
  const Vec3 cross = glm::cross(p.b.x, p.b.y);
  const float det = glm::dot(cross, cross) + kBlurVariance * (bxx + byy + kBlurVariance);
  p.conic = {p.cov.yy / det, -p.cov.xy / det, p.cov.xx / det};
  return p;
}

/// The plane as one Gaussian sees it: d(μ), local normal Mᵀn and s_n² = nᵀΣn.
struct PlaneView {
  float d;
  Vec3 local;
  float variance;
};

PlaneView see_plane(const Projection& p, const Vec3& mean, const Plane& plane) {
  PlaneView v;
  v.d = plane.signed_distance(mean);
  v.local = plane.normal * p.m;
  v.variance = glm::dot(v.local, v.local);
  return v;
}

/// Conditioning of the plane distance on the pixel offset (method.md §3, exact).
struct Conditional {
  Vec2 c;       // A Σ n
  Vec2 k;       // Σ₂⁻¹ c
  float inv_s;  // 1/s
  bool clamped;
};

Conditional condition(const Projection& p, const PlaneView& v) {
  Conditional e;
  e.c = {glm::dot(p.b.x, v.local), glm::dot(p.b.y, v.local)};
  e.k = p.conic * e.c;
  const float s2 = v.variance - glm::dot(e.c, e.k);
  const float floor = kMinConditionalVariance * v.variance;
  e.clamped = s2 < floor;
  e.inv_s = 1.0f / std::sqrt(std::max(s2, floor));
  return e;
}

/// Share that the soft operator keeps of a Gaussian.
float soft_share(const Projection& p, const Vec3& mean, std::span<const LitPlane> planes) {
  float product = 1;
  float last = 1;
  for (size_t k = 0; k < planes.size(); ++k) {
    const PlaneView v = see_plane(p, mean, planes[k]);
    const float share = std::clamp(0.5f + v.d / (2 * std::sqrt(v.variance)), 0.0f, 1.0f);
    if (k > 0 && are_opposite(planes[k - 1], planes[k])) {
      last = std::max(0.0f, last + share - 1);
    } else {
      product *= last;
      last = share;
    }
  }
  return product * last;
}

/// What the planes leave of a Gaussian; false: nothing.
bool cut(const Projection& p, const Vec3& mean, std::span<const LitPlane> planes,
         const RasterOptions& options, bool per_pixel, Splat& splat, PlaneCut* more) {
  splat.clipped = 0;
  splat.z0 = splat.zx = splat.zy = 0;
  if (options.clip == ClipOperator::kSoft) {
    splat.opacity *= soft_share(p, mean, planes);
  }
  if (!per_pixel) {
    return true;
  }
  const LitPlane* before = nullptr;  // the plane before, if it cuts the Gaussian
  for (const LitPlane& plane : planes) {
    const PlaneView v = see_plane(p, mean, plane);
    const float deviation = std::sqrt(v.variance);
    if (v.d < -options.clip_sigma * deviation) {
      return false;
    }
    if (v.d >= options.clip_sigma * deviation) {
      before = nullptr;
      continue;
    }
    const Conditional e = condition(p, v);
    const Vec3 z(v.d * e.inv_s, e.k.x * e.inv_s, e.k.y * e.inv_s);
    if (splat.clipped == 0) {
      splat.z0 = z.x;
      splat.zx = z.y;
      splat.zy = z.z;
    } else {
      more[splat.clipped - 1] = {z.x, z.y, z.z, before != nullptr && are_opposite(*before, plane)};
    }
    ++splat.clipped;
    before = &plane;
  }
  return true;
}

/// What the planes' faces make of a Gaussian's own colour: (colour + added)·factor.
struct FaceLight {
  Vec3 added{0};
  Vec3 factor{1};
};

/// `direction`: unit, from the eye to the mean.
FaceLight face_light(const Gaussians& gaussians, size_t i, const Projection& p, const Vec3& mean,
                     const Vec3& direction, std::span<const LitPlane> planes) {
  FaceLight light;
  for (const LitPlane& plane : planes) {
    if (plane.gain == Vec3(1) && !gaussians.has_face_colors()) {
      continue;  // its face looks like the rest
    }
    const PlaneView v = see_plane(p, mean, plane);
    const float share = FaceGain::share(v.d / std::sqrt(v.variance)) *
                        FaceGain::facing(glm::dot(plane.normal, direction));
    if (share > 0) {
      light.factor *= Vec3(1) + share * (plane.gain - Vec3(1));
      if (gaussians.has_face_colors()) {
        light.added += share * face_color(gaussians, i, plane.normal);
      }
    }
  }
  return light;
}

float sigmoid(float x) { return 1.0f / (1.0f + std::exp(-x)); }

}  // namespace

bool project(const Gaussians& gaussians, size_t i, const Camera& camera,
             std::span<const LitPlane> planes, const RasterOptions& options, Splat& splat,
             PlaneCut* more) {
  const Vec3 mean = gaussians.mean(i);
  const Vec3 t = camera.to_camera(mean);
  if (!in_front(t)) {
    return false;
  }
  splat.opacity = gaussians.opacity(i);
  if (splat.opacity < options.alpha_min) {
    return false;
  }
  if (options.clip == ClipOperator::kHard &&
      std::ranges::any_of(planes, [&](const LitPlane& p) { return p.signed_distance(mean) < 0; })) {
    return false;
  }
  const bool by_layer = options.clip == ClipOperator::kLayers;
  const LayerPart part = by_layer ? options.layers.part(i) : LayerPart::kCut;
  if (part == LayerPart::kOff) {
    return false;
  }
  const bool per_pixel =
      options.clip == ClipOperator::kExact || (by_layer && part == LayerPart::kCut);
  const Projection p = project_geometry(gaussians, i, camera, t);
  if (!cut(p, mean, planes, options, per_pixel, splat, more) || splat.opacity < options.alpha_min) {
    return false;
  }
  splat.x = camera.fx * t.x / t.z + camera.cx;
  splat.y = camera.fy * t.y / t.z + camera.cy;
  const float radius = std::sqrt(2 * std::log(splat.opacity / options.alpha_min));
  splat.extent_x = radius * std::sqrt(p.cov.xx);
  splat.extent_y = radius * std::sqrt(p.cov.yy);
  const bool in_picture = splat.x + splat.extent_x >= 0 && splat.y + splat.extent_y >= 0 &&
                          splat.x - splat.extent_x <= static_cast<float>(camera.width) &&
                          splat.y - splat.extent_y <= static_cast<float>(camera.height);
  if (!in_picture) {  // nor is what is too large or too far for numbers
    return false;
  }
  splat.qa = -0.5f * p.conic.xx;
  splat.qb = -p.conic.xy;
  splat.qc = -0.5f * p.conic.yy;
  splat.depth = t.z;
  const Vec3 direction = glm::normalize(mean - camera.position);
  const FaceLight light = face_light(gaussians, i, p, mean, direction, planes);
  const Vec3 own = sh_color(gaussians, i, direction);
  const float kept = options.cue.kept(glm::length(mean - camera.position));
  const Vec3 color = kept * (own + light.added) * light.factor;
  splat.r = std::max(0.0f, color.x);
  splat.g = std::max(0.0f, color.y);
  splat.b = std::max(0.0f, color.z);
  return true;
}

Vec3 project_backward(const Gaussians& gaussians, size_t i, const Camera& camera,
                      std::span<const LitPlane> planes, const RasterOptions& options,
                      const Splat& splat, const SplatGradient& g, Gaussians& gradients) {
  const LitPlane* const plane = planes.empty() ? nullptr : planes.data();
  const Vec3 mean = gaussians.mean(i);
  const Projection p = project_geometry(gaussians, i, camera, camera.to_camera(mean));

  // Pixels → splat: δ = pixel − centre, α ∝ exp(qa·δx² + qb·δxδy + qc·δy²)·Φ(z).
  Vec2 g_center(p.conic.xx * g.hx + p.conic.xy * g.hy, p.conic.xy * g.hx + p.conic.yy * g.hy);
  Sym2 g_conic{-0.5f * g.hxx, -0.5f * g.hxy, -0.5f * g.hyy};
  const float g_opacity = g.h / splat.opacity;  // with respect to the splat's, soft factor included

  Vec3 g_mean(0);
  Mat3 g_m(0);
  Rows g_b{Vec3(0), Vec3(0)};
  float soft = 1;
  if (plane != nullptr && options.clip == ClipOperator::kSoft) {
    const PlaneView v = see_plane(p, mean, *plane);
    const float deviation = std::sqrt(v.variance);
    const float w = 0.5f + v.d / (2 * deviation);
    soft = std::clamp(w, 0.0f, 1.0f);
    if (w > 0 && w < 1) {
      const float g_w = g_opacity * gaussians.opacity(i);
      g_mean += (g_w / (2 * deviation)) * plane->normal;
      const float g_variance = -g_w * v.d / (4 * v.variance * deviation);
      g_m += glm::outerProduct(plane->normal, 2 * g_variance * v.local);
    }
  }
  if (plane != nullptr && splat.clipped != 0) {
    const PlaneView v = see_plane(p, mean, *plane);
    const Conditional e = condition(p, v);
    g_center -= g.e * Vec2(splat.zx, splat.zy);  // z moves with the centre
    const Vec2 g_z_slope(g.ex, g.ey);
    g_mean += g.e * e.inv_s * plane->normal;
    Vec2 g_k = g_z_slope * e.inv_s;
    Vec2 g_c(0);
    float g_variance = 0;
    const float g_inv_s = g.e * v.d + glm::dot(g_z_slope, e.k);
    const float g_s2 = -0.5f * g_inv_s * e.inv_s * e.inv_s * e.inv_s;
    if (e.clamped) {
      g_variance = kMinConditionalVariance * g_s2;
    } else {
      g_variance = g_s2;
      g_c -= g_s2 * e.k;
      g_k -= g_s2 * e.c;
    }
    g_conic.xx += g_k.x * e.c.x;
    g_conic.xy += 0.5f * (g_k.x * e.c.y + g_k.y * e.c.x);
    g_conic.yy += g_k.y * e.c.y;
    g_c += p.conic * g_k;
    g_b.x += g_c.x * v.local;
    g_b.y += g_c.y * v.local;
    const Vec3 g_local = 2 * g_variance * v.local + g_c.x * p.b.x + g_c.y * p.b.y;
    g_m += glm::outerProduct(plane->normal, g_local);
  }

  // Colour; a channel clamped at 0 has no gradient.
  Vec3 g_color(splat.r > 0 ? g.r : 0, splat.g > 0 ? g.g : 0, splat.b > 0 ? g.b : 0);
  Vec3 g_gain(0);
  Vec3 g_face(0);
  if (plane != nullptr) {
    const PlaneView v = see_plane(p, mean, *plane);
    const float deviation = std::sqrt(v.variance);
    const float depth = v.d / deviation;
    const float away = glm::length(mean - camera.position);
    const Vec3 direction = (mean - camera.position) / away;
    const float cosine = glm::dot(plane->normal, direction);
    const float near_face = FaceGain::share(depth);
    const float facing = FaceGain::facing(cosine);
    const float share = near_face * facing;
    const Vec3 factor = Vec3(1) + share * (plane->gain - Vec3(1));
    // Where a channel is not clamped its colour is what is drawn, and the factor is positive.
    const Vec3 g_factor = g_color * Vec3(splat.r, splat.g, splat.b) / factor;
    g_gain = share * g_factor;
    g_color *= factor;
    float g_share = glm::dot(g_factor, plane->gain - Vec3(1));
    if (gaussians.has_face_colors()) {
      g_face = share * g_color;
      g_share += glm::dot(g_color, face_color(gaussians, i, plane->normal));
    }
    const float g_cosine = g_share * near_face * FaceGain::facing_slope(cosine);
    g_mean += (g_cosine / away) * (plane->normal - cosine * direction);
    const float g_depth = g_share * facing * FaceGain::share_slope(depth);
    g_mean += (g_depth / deviation) * plane->normal;
    const float g_variance = -0.5f * g_depth * depth / v.variance;
    g_m += glm::outerProduct(plane->normal, 2 * g_variance * v.local);
  }

  if (gaussians.has_face_colors()) {
    face_color_backward(i, plane != nullptr ? plane->normal : Vec3(0, 0, 1), g_face, gradients);
  }

  // Σ₂⁻¹ → Σ₂ = B Bᵀ + blur: ∂Σ₂ = −Q·∂Q·Q.
  const Sym2& q = p.conic;
  const float t00 = q.xx * g_conic.xx + q.xy * g_conic.xy;
  const float t01 = q.xx * g_conic.xy + q.xy * g_conic.yy;
  const float t10 = q.xy * g_conic.xx + q.yy * g_conic.xy;
  const float t11 = q.xy * g_conic.xy + q.yy * g_conic.yy;
  const Sym2 g_cov{-(t00 * q.xx + t01 * q.xy), -(t00 * q.xy + t01 * q.yy),
                   -(t10 * q.xy + t11 * q.yy)};
  g_b.x += 2.0f * (g_cov.xx * p.b.x + g_cov.xy * p.b.y);
  g_b.y += 2.0f * (g_cov.xy * p.b.x + g_cov.yy * p.b.y);

  // B = A·M, A = J·W.
  g_m += glm::outerProduct(p.a.x, g_b.x) + glm::outerProduct(p.a.y, g_b.y);
  const Vec3 g_jx = camera.rotation * (p.m * g_b.x);  // row of ∂L/∂J
  const Vec3 g_jy = camera.rotation * (p.m * g_b.y);

  const float iz = 1 / p.t.z;
  const float jx = camera.fx * iz;
  const float jy = camera.fy * iz;
  Vec3 g_t(0);
  g_t.x += g_center.x * jx;
  g_t.y += g_center.y * jy;
  g_t.z -= (g_center.x * jx * p.t.x + g_center.y * jy * p.t.y) * iz;
  g_t.z -= (g_jx.x * jx + g_jy.y * jy) * iz;
  // J02 = −fx·lx/z with lx = t.x/t.z where the clamp is idle, else constant.
  g_t.z += (g_jx.z * jx * p.lx + g_jy.z * jy * p.ly) * iz;
  if (p.inside_x) {
    g_t.x -= g_jx.z * jx * iz;
    g_t.z += g_jx.z * jx * p.lx * iz;
  }
  if (p.inside_y) {
    g_t.y -= g_jy.z * jy * iz;
    g_t.z += g_jy.z * jy * p.ly * iz;
  }
  g_mean += g_t * camera.rotation;  // Wᵀ g

  g_mean += sh_color_backward(gaussians, i, mean - camera.position, g_color, gradients);

  // M = R·diag(s), s = exp(log s).
  for (int axis = 0; axis < 3; ++axis) {
    gradients.plane(Gaussians::kMean + axis)[i] = g_mean[axis];
    gradients.plane(Gaussians::kLogScale + axis)[i] = glm::dot(g_m[axis], p.m[axis]);
  }
  const Mat3 g_r(g_m[0] * p.scale.x, g_m[1] * p.scale.y, g_m[2] * p.scale.z);
  const Quat g_q = rotation_backward(p.q, p.q_norm, g_r);
  gradients.plane(Gaussians::kRotation + 0)[i] = g_q.w;
  gradients.plane(Gaussians::kRotation + 1)[i] = g_q.x;
  gradients.plane(Gaussians::kRotation + 2)[i] = g_q.y;
  gradients.plane(Gaussians::kRotation + 3)[i] = g_q.z;

  const float o = sigmoid(gaussians.plane(Gaussians::kOpacity)[i]);
  gradients.plane(Gaussians::kOpacity)[i] = g_opacity * soft * o * (1 - o);
  return g_gain;
}

}  // namespace clipgs
