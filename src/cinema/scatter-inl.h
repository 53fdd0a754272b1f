// The functions of cinema/scatter.h on vectors of paths. Included once per instruction set.
#if defined(CLIPGS_CINEMA_SCATTER_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef CLIPGS_CINEMA_SCATTER_INL_H
#undef CLIPGS_CINEMA_SCATTER_INL_H
#else
#define CLIPGS_CINEMA_SCATTER_INL_H
#endif

#include <numbers>

#include "cinema/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace clipgs {  // NOLINT(modernize-concat-nested-namespaces): the inner one is a macro
namespace HWY_NAMESPACE {
namespace lanes {

constexpr float kTurn = 2 * std::numbers::pi_v<float>;

/// r·(cos 2πv, sin 2πv) in the plane of two vectors, and `height` along a third.
HWY_INLINE Float3 cylinder(Float r, Float v, Float height, Float3 tangent, Float3 bitangent,
                           Float3 axis) {
  const Float phi = Float(kTurn) * v;
  return r * cos(phi) * tangent + r * sin(phi) * bitangent + height * axis;
}

HWY_INLINE Float3 sample_cosine(Float3 normal, Float u, Float v) {
  Float3 tangent;
  Float3 bitangent;
  orthonormal_basis(normal, tangent, bitangent);
  return cylinder(sqrt(u), v, sqrt(Float(1) - u), tangent, bitangent, normal);
}

HWY_INLINE Float henyey_greenstein(Float cosine, Float g) {
  const Float s = Float(1) + g * g - Float(2) * g * cosine;
  return Float(0.25f * std::numbers::inv_pi_v<float>) * (Float(1) - g * g) / (s * sqrt(s));
}

HWY_INLINE Float3 sample_henyey_greenstein(Float3 direction, Float g, Float u, Float v) {
  const Mask turns = abs(g) > Float(1e-3f);
  const Float some = select(turns, g, Float(1));  // any divisor where it does not matter
  const Float s = (Float(1) - g * g) / (Float(1) - g + Float(2) * g * u);
  const Float cosine =
      select(turns, (Float(1) + g * g - s * s) / (Float(2) * some), Float(1) - Float(2) * u);
  const Float sine = sqrt(max(Float(0), Float(1) - cosine * cosine));
  Float3 tangent;
  Float3 bitangent;
  orthonormal_basis(direction, tangent, bitangent);
  return cylinder(sine, v, cosine, tangent, bitangent, direction);
}

namespace ggx {

HWY_INLINE Float lambda(Float cosine, Float alpha) {
  const Float c2 = cosine * cosine;
  const Float tan2 = max(Float(0), Float(1) - c2) / max(c2, Float(1e-8f));
  return Float(0.5f) * (sqrt(Float(1) + alpha * alpha * tan2) - Float(1));
}

/// Density of microfacets whose normal has this cosine, D(h).
HWY_INLINE Float facets(Float cosine, Float alpha) {
  const Float a2 = alpha * alpha;
  const Float s = cosine * cosine * (a2 - Float(1)) + Float(1);
  return a2 / (Float(std::numbers::pi_v<float>) * s * s);
}

HWY_INLINE Float evaluate(Float3 normal, Float3 out, Float3 in, Float alpha) {
  const Float cos_out = dot(normal, out);
  const Float cos_in = dot(normal, in);
  const Mask above = (cos_out > Float(0)) & (cos_in > Float(0));
  const Float density = facets(dot(normal, normalize(out + in)), alpha);
  const Float masking = Float(1) / (Float(1) + lambda(cos_out, alpha) + lambda(cos_in, alpha));
  return or_zero(above, density * masking / (Float(4) * cos_out));
}

/// Probability density of `sample`'s directions, 1/sr.
HWY_INLINE Float density(Float3 normal, Float3 out, Float3 in, Float alpha) {
  const Float cos_out = dot(normal, out);
  const Mask above = (cos_out > Float(0)) & (dot(normal, in) > Float(0));
  const Float half = facets(dot(normal, normalize(out + in)), alpha);
  return or_zero(above, half / ((Float(1) + lambda(cos_out, alpha)) * Float(4) * cos_out));
}

HWY_INLINE Float3 sample(Float3 normal, Float3 out, Float alpha, Float u, Float v, Float& weight) {
  Float3 tangent;
  Float3 bitangent;
  orthonormal_basis(normal, tangent, bitangent);
  const Float3 local(dot(out, tangent), dot(out, bitangent), dot(out, normal));
  const Float3 stretched = normalize({alpha * local.x, alpha * local.y, local.z});
  const Float length2 = stretched.x * stretched.x + stretched.y * stretched.y;
  const Float scale = Float(1) / sqrt(max(length2, Float(1e-12f)));
  const Mask inclined = length2 > Float(1e-12f);
  const Float3 side(select(inclined, -stretched.y * scale, Float(1)),
                    select(inclined, stretched.x * scale, Float(0)), Float(0));
  const Float3 upwards = cross(stretched, side);
  const Float r = sqrt(u);
  const Float phi = Float(kTurn) * v;
  const Float p = r * cos(phi);
  const Float s = Float(0.5f) * (Float(1) + stretched.z);
  const Float q = (Float(1) - s) * sqrt(max(Float(0), Float(1) - p * p)) + s * r * sin(phi);
  const Float3 facet =
      p * side + q * upwards + sqrt(max(Float(0), Float(1) - p * p - q * q)) * stretched;
  const Float3 half = normalize({alpha * facet.x, alpha * facet.y, max(Float(1e-6f), facet.z)});
  const Float3 in = Float(2) * dot(local, half) * half - local;
  const Float visible = lambda(local.z, alpha);
  weight =
      or_zero(in.z > Float(0), (Float(1) + visible) / (Float(1) + visible + lambda(in.z, alpha)));
  return in.x * tangent + in.y * bitangent + in.z * normal;
}

}  // namespace ggx
}  // namespace lanes
}  // namespace HWY_NAMESPACE
}  // namespace clipgs
HWY_AFTER_NAMESPACE();

#endif
