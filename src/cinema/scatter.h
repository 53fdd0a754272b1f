#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry.h"

// How light turns at a vertex: Lambert and GGX surfaces, Henyey–Greenstein volumes. Directions are
// unit vectors that point away from the vertex.
namespace clipgs {

/// Cosine-weighted direction about unit `normal` (Malley).
inline Vec3 sample_cosine(const Vec3& normal, float u, float v) {
  Vec3 tangent;
  Vec3 bitangent;
  orthonormal_basis(normal, tangent, bitangent);
  const float r = std::sqrt(u);
  const float phi = 2.0f * std::numbers::pi_v<float> * v;
  return r * (std::cos(phi) * tangent + std::sin(phi) * bitangent) + std::sqrt(1.0f - u) * normal;
}

/// Henyey–Greenstein phase function, 1/sr; `cosine` between the light's old and new direction.
inline float henyey_greenstein(float cosine, float g) {
  constexpr float kInverse4Pi = 0.25f * std::numbers::inv_pi_v<float>;
  const float s = 1.0f + g * g - 2.0f * g * cosine;
  return kInverse4Pi * (1.0f - g * g) / (s * std::sqrt(s));
}

/// Direction after scattering by Henyey–Greenstein of a ray that ran along `direction`.
inline Vec3 sample_henyey_greenstein(const Vec3& direction, float g, float u, float v) {
  float cosine = 1.0f - 2.0f * u;
  if (std::abs(g) > 1e-3f) {
    const float s = (1.0f - g * g) / (1.0f - g + 2.0f * g * u);
    cosine = (1.0f + g * g - s * s) / (2.0f * g);
  }
  const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
  const float phi = 2.0f * std::numbers::pi_v<float> * v;
  Vec3 tangent;
  Vec3 bitangent;
  orthonormal_basis(direction, tangent, bitangent);
  return cosine * direction + sine * (std::cos(phi) * tangent + std::sin(phi) * bitangent);
}

/// Isotropic GGX with a white specular colour (F = 1), Smith masking (Walter 2007, Heitz 2014).
namespace ggx {

inline float lambda(float cosine, float alpha) {
  const float c2 = cosine * cosine;
  const float tan2 = std::max(0.0f, 1.0f - c2) / std::max(c2, 1e-8f);
  return 0.5f * (std::sqrt(1.0f + alpha * alpha * tan2) - 1.0f);
}

/// BRDF times the cosine of `in`; both directions on the side of `normal`.
inline float evaluate(const Vec3& normal, const Vec3& out, const Vec3& in, float alpha) {
  const float cos_out = glm::dot(normal, out);
  const float cos_in = glm::dot(normal, in);
  if (cos_out <= 0 || cos_in <= 0) {
    return 0;
  }
  const float cos_half = glm::dot(normal, glm::normalize(out + in));
  const float a2 = alpha * alpha;
  const float s = cos_half * cos_half * (a2 - 1.0f) + 1.0f;
  const float density = a2 / (std::numbers::pi_v<float> * s * s);
  const float masking = 1.0f / (1.0f + lambda(cos_out, alpha) + lambda(cos_in, alpha));
  return density * masking / (4.0f * cos_out);
}

/// Reflects `out` about a visible microfacet (Heitz 2018); the sample's weight, BRDF·cosine/pdf, is
/// in `weight`. The result may point below the surface: its weight is then 0.
inline Vec3 sample(const Vec3& normal, const Vec3& out, float alpha, float u, float v,
                   float& weight) {
  Vec3 tangent;
  Vec3 bitangent;
  orthonormal_basis(normal, tangent, bitangent);
  const Vec3 local(glm::dot(out, tangent), glm::dot(out, bitangent), glm::dot(out, normal));
  // The hemisphere of stretched microfacets, seen from `out`.
  const Vec3 stretched = glm::normalize(Vec3(alpha * local.x, alpha * local.y, local.z));
  const float length2 = stretched.x * stretched.x + stretched.y * stretched.y;
  const Vec3 side =
      length2 > 1e-12f ? Vec3(-stretched.y, stretched.x, 0) / std::sqrt(length2) : Vec3(1, 0, 0);
  const Vec3 upwards = glm::cross(stretched, side);
  const float r = std::sqrt(u);
  const float phi = 2.0f * std::numbers::pi_v<float> * v;
  const float p = r * std::cos(phi);
  const float s = 0.5f * (1.0f + stretched.z);
  const float q = (1.0f - s) * std::sqrt(std::max(0.0f, 1.0f - p * p)) + s * r * std::sin(phi);
  const Vec3 facet =
      p * side + q * upwards + std::sqrt(std::max(0.0f, 1.0f - p * p - q * q)) * stretched;
  const Vec3 half =
      glm::normalize(Vec3(alpha * facet.x, alpha * facet.y, std::max(1e-6f, facet.z)));
  const Vec3 in = 2.0f * glm::dot(local, half) * half - local;
  const float visible = lambda(local.z, alpha);
  weight = in.z <= 0 ? 0.0f : (1.0f + visible) / (1.0f + visible + lambda(in.z, alpha));
  return in.x * tangent + in.y * bitangent + in.z * normal;
}

}  // namespace ggx
}  // namespace clipgs
