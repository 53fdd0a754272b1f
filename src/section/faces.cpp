#include "section/faces.h"

#include "core/parallel.h"
#include "section/face_light.h"
#include "section/face_rays.h"

namespace clipgs {
namespace {

/// Linear premultiplied radiance before exposure, and alpha, along one ray.
Vec4 shade(const Section& section, const FaceRays& rays, const FaceRay& ray) {
  Vec3 light(0);
  const auto add = [&](float weight, const Vec3& sampled, float, const FaceMaterial& material,
                       bool surface) {
    Vec3 radiance = (surface ? material.surface : material.interior) * ray.face->light;
    if (section.channels == 3) {
      radiance *= photo_albedo(sampled);
    }
    if (surface && material.specular > 0) {
      radiance += material.specular *
                  face_gloss(section.rig, ray.face->outward, -ray.direction, material.roughness);
    }
    light += weight * radiance;
  };
  const float alpha = rays.march(ray, add);
  return {light, alpha};
}

/// Premultiplied display sRGB and alpha of pixel (x, y).
Vec4 shade_pixel(const Section& section, const FaceRays& rays, int x, int y, int samples) {
  Vec4 sum(0);
  const float step = 1.0f / static_cast<float>(samples);
  for (int i = 0; i < samples * samples; ++i) {
    const float u = static_cast<float>(x) + (static_cast<float>(i % samples) + 0.5f) * step;
    const float v = static_cast<float>(y) + (static_cast<float>(i / samples) + 0.5f) * step;
    if (const std::optional<FaceRay> ray = rays.through(u, v)) {
      sum += shade(section, rays, *ray);
    }
  }
  sum *= step * step;
  if (sum.a <= 0) {
    return Vec4(0);
  }
  const float scale = section.exposure / sum.a;
  return {sum.a * srgb_from_linear(scale * sum.r), sum.a * srgb_from_linear(scale * sum.g),
          sum.a * srgb_from_linear(scale * sum.b), sum.a};
}

}  // namespace

Image draw_faces(const Section& section, const Camera& camera, std::span<const Plane> planes,
                 const FaceOptions& options) {
  Image image(camera.width, camera.height, 4);
  const FaceRays rays(section, camera, planes, options.taps);
  if (!rays.any()) {
    return image;
  }
  const int samples = options.samples > 0 ? options.samples : rays.samples_for_detail();
  parallel_for(static_cast<size_t>(camera.height), 4, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < camera.width; ++x) {
        const Vec4 color = shade_pixel(section, rays, x, y, samples);
        float* out = image.at(x, y);
        for (int c = 0; c < 4; ++c) {
          out[c] = color[c];
        }
      }
    }
  });
  return image;
}

void put_in_front(const Image& faces, Image& picture) {
  for (size_t i = 0; i < picture.data.size(); i += 4) {
    const float behind = 1 - faces.data[i + 3];
    for (size_t c = 0; c < 4; ++c) {
      picture.data[i + c] = faces.data[i + c] + behind * picture.data[i + c];
    }
  }
}

}  // namespace clipgs
