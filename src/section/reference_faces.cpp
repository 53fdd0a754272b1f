#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "section/face_light.h"
#include "section/face_rays.h"
#include "section/faces.h"

namespace clipgs {
namespace {

using DVec3 = glm::dvec3;

constexpr double kStepVoxels = 0.01;  // of the traced volume
constexpr double kReferenceDepthVoxels = 4;

/// Section::sample() by the definition: a sum over eight corners with their weights.
DVec3 sample(const Section& section, const DVec3& index) {
  DVec3 sum(0);
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    IVec3 at;
    for (int k = 0; k < 3; ++k) {
      const double x = std::clamp(index[k], 0.0, static_cast<double>(section.dims[k] - 1));
      const int low = static_cast<int>(std::floor(x));
      const bool upper = ((corner >> k) & 1) != 0;
      weight *= upper ? x - low : 1 - (x - low);
      at[k] = std::min(low + (upper ? 1 : 0), section.dims[k] - 1);
    }
    for (int c = 0; c < section.channels; ++c) {
      const size_t offset =
          (static_cast<size_t>(at.z) * section.dims.y + at.y) * section.dims.x + at.x;
      const std::uint8_t code = section.voxels[offset * section.channels + c];
      sum[c] += weight * (section.channels == 1 ? section.curve.values()[code] : code);
    }
  }
  return sum;
}

template <typename Get>
auto lerp(const Section& section, double code, const Get& get) {
  const auto low = static_cast<size_t>(std::min(code, 254.0));
  const double t = code - static_cast<double>(low);
  return get(section.materials[low]) * (1 - t) + get(section.materials[low + 1]) * t;
}

glm::dvec4 trace(const Section& section, const Camera& camera, std::span<const Plane> planes,
                 const DVec3& direction) {
  const DVec3 eye(camera.position);
  const double voxel = mean_spacing(section.source_spacing);
  const double step = kStepVoxels * voxel;

  // The first point that every plane keeps, and the last.
  double enter = 0;
  double leave = 1e30;
  const Plane* face = nullptr;
  for (const Plane& plane : planes) {
    const double slope = glm::dot(DVec3(plane.normal), direction);
    const double distance = glm::dot(DVec3(plane.normal), eye) - plane.offset;
    if (slope > 0 && -distance / slope > enter) {
      enter = -distance / slope;
      face = &plane;
    }
    if (slope < 0) {
      leave = std::min(leave, -distance / slope);
    }
  }
  glm::dvec4 result(0);
  if (face == nullptr) {
    return result;
  }
  const Vec3 outward = -face->normal;
  const DVec3 light(face_diffuse(section.rig, outward));
  const double surface = section.surface_depth();
  const double slope = glm::dot(DVec3(face->normal), direction);
  double transmittance = 1;
  const double end = std::min(leave, enter + kReferenceDepthVoxels * voxel);
  const int steps = std::max(0, static_cast<int>(std::ceil((end - enter) / step - 0.5)));
  for (int i = 0; i < steps; ++i) {
    const double t = enter + (i + 0.5) * step;
    const DVec3 index =
        ((eye + t * direction - DVec3(section.origin)) * glm::dmat3(section.direction)) /
        DVec3(section.spacing);
    const double slack = 1e-3;  // voxels: a side may be the face
    const bool inside = glm::all(glm::greaterThanEqual(index, DVec3(-slack))) &&
                        glm::all(glm::lessThanEqual(index, DVec3(section.dims - 1) + slack));
    if (!inside) {
      if (t - enter < step) {
        return result;
      }
      break;
    }
    const DVec3 sampled = sample(section, index);
    const double code = section.curve.code(section.value(Vec3(sampled)));
    const double extinction = lerp(
        section, code, [](const FaceMaterial& m) { return static_cast<double>(m.extinction); });
    const bool at_face = (t - enter) * slope < surface;
    const bool met = transmittance < 1;
    if (met ? extinction <= 0 : !at_face) {
      break;  // a gap: what lies beyond is another surface
    }
    const double alpha = 1 - std::exp(-extinction * step);
    DVec3 radiance = light * lerp(section, code, [&](const FaceMaterial& m) {
                       return DVec3(at_face ? m.surface : m.interior);
                     });
    if (section.channels == 3) {
      for (int c = 0; c < 3; ++c) {
        radiance[c] *= linear_from_srgb(static_cast<float>(sampled[c] / 255));
      }
    }
    if (at_face) {
      const double specular = lerp(
          section, code, [](const FaceMaterial& m) { return static_cast<double>(m.specular); });
      const double roughness = lerp(
          section, code, [](const FaceMaterial& m) { return static_cast<double>(m.roughness); });
      radiance += specular * DVec3(face_gloss(section.rig, outward, -Vec3(direction),
                                              static_cast<float>(roughness)));
    }
    result += glm::dvec4(transmittance * alpha * radiance, transmittance * alpha);
    transmittance *= 1 - alpha;
  }
  return result;
}

}  // namespace

Image draw_faces_reference(const Section& section, const Camera& camera, const Cut& cut, int rays) {
  Image image(camera.width, camera.height, 4);
  std::vector<Plane> faces(cut.planes().begin(), cut.planes().end());
  const std::vector<Plane> ends = section.ends();
  faces.insert(faces.end(), ends.begin(), ends.end());
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      glm::dvec4 sum(0);
      for (int i = 0; i < rays; ++i) {
        const Vec2 at = place_in_pixel(i, rays);
        const DVec3 local((x + double{at.x} - camera.cx) / camera.fx,
                          (y + double{at.y} - camera.cy) / camera.fy, 1.0);
        sum += trace(section, camera, faces, glm::normalize(local * glm::dmat3(camera.rotation)));
      }
      sum /= static_cast<double>(rays);
      float* out = image.at(x, y);
      for (int c = 0; c < 3 && sum.a > 0; ++c) {
        const auto straight = static_cast<float>(section.exposure * sum[c] / sum.a);
        out[c] = static_cast<float>(sum.a) * display_from_linear(straight, section.tone);
      }
      out[3] = static_cast<float>(sum.a);
    }
  }
  return image;
}

}  // namespace clipgs
