#include "section/faces.h"

#include "core/parallel.h"
#include "section/face_light.h"
#include "section/face_rays.h"

namespace clipgs {
namespace {

/// Sums what the rays of one pixel see.
class PixelSum {
 public:
  PixelSum(const Section& section, const FaceRays& rays) : section_(section), rays_(rays) {}

  void add(const FaceRay& ray) {
    if (ray.face != face_) {
      finish_gloss();
      face_ = ray.face;
      out_ = -ray.direction;
    }
    Vec3 light(0);
    const auto visit = [&](float weight, const Vec3& sampled, float, const FaceMaterial& material,
                           bool surface) {
      Vec3 reflected = weight * (surface ? material.surface : material.interior);
      if (section_.channels == 3) {
        reflected *= photo_albedo(sampled);
      }
      light += reflected;
      if (surface) {
        specular_ += weight * material.specular;
        roughness_ += weight * material.specular * material.roughness;
      }
    };
    alpha_ += rays_.march(ray, visit);
    light_ += light * face_->light;
  }

  /// Premultiplied display sRGB and alpha, for `count` rays, some of which met no face.
  Vec4 display(int count) {
    if (alpha_ <= 0) {
      return Vec4(0);
    }
    finish_gloss();
    const float alpha = alpha_ / static_cast<float>(count);
    const Vec3 light = section_.exposure / alpha_ * light_;
    return {alpha * srgb_from_linear(light.r), alpha * srgb_from_linear(light.g),
            alpha * srgb_from_linear(light.b), alpha};
  }

 private:
  // Gloss changes slowly: one lobe, of the mean roughness, is right for a pixel's part of a face.
  void finish_gloss() {
    if (specular_ > 0) {
      light_ += specular_ * face_gloss(section_.rig, face_->outward, out_, roughness_ / specular_);
    }
    specular_ = 0;
    roughness_ = 0;
  }

  const Section& section_;
  const FaceRays& rays_;
  const Face* face_ = nullptr;
  Vec3 out_{0};  // towards the camera
  Vec3 light_{0};
  float alpha_ = 0;
  float specular_ = 0;   // weights of the face's gloss …
  float roughness_ = 0;  // … and their sum with its roughness
};

Vec4 draw_pixel(const Section& section, const FaceRays& rays, int x, int y, int samples) {
  PixelSum sum(section, rays);
  rays.for_rays(x, y, samples, [&](const FaceRay& ray) { sum.add(ray); });
  return sum.display(samples * samples);
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
        const Vec4 color = draw_pixel(section, rays, x, y, samples);
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
