#include "section/faces.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "section/face_light.h"
#include "section/face_rays.h"

namespace clipgs {
namespace {

/// srgb_from_linear() by a table over the square root, which spreads the dark end: within 1e-5.
class DisplayCurve {
 public:
  DisplayCurve() {
    for (size_t i = 0; i < values_.size(); ++i) {
      const float root = static_cast<float>(i) / kSteps;
      values_[i] = srgb_from_linear(root * root);
    }
  }
  float operator()(float linear) const {
    const float at = kSteps * std::sqrt(std::clamp(linear, 0.0f, 1.0f));
    const size_t low = std::min(static_cast<size_t>(at), static_cast<size_t>(kSteps) - 1);
    return values_[low] + (at - static_cast<float>(low)) * (values_[low + 1] - values_[low]);
  }

 private:
  static constexpr float kSteps = 1024;
  std::array<float, static_cast<size_t>(kSteps) + 1> values_;
};

float display(float linear) {
  static const DisplayCurve curve;
  return curve(linear);
}

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
  Vec4 color(int count) {
    if (alpha_ <= 0) {
      return Vec4(0);
    }
    finish_gloss();
    const float alpha = alpha_ / static_cast<float>(count);
    const Vec3 light = section_.exposure / alpha_ * light_;
    return {alpha * display(light.r), alpha * display(light.g), alpha * display(light.b), alpha};
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

/// How much of a face is inside the body, in grey: codes between those of the air around it and of
/// all else come from interpolation.
float inside_share(float code) {
  constexpr float kLow = 0.25f * Section::kFirstInside;
  constexpr float kHigh = 0.75f * Section::kFirstInside;
  return std::clamp((code - kLow) / (kHigh - kLow), 0.0f, 1.0f);
}

/// What the ray meets on the face in grey: premultiplied display sRGB and alpha.
Vec4 grey_at(const Section& section, const FaceRays& rays, const FaceRay& ray,
             const Window& window) {
  const Vec3 index = rays.index_at(ray, ray.enter);
  const Vec3 sampled = section.sample(index);
  const float alpha = inside_share(section.code(index));
  if (section.channels == 3) {
    return {alpha * sampled / 255.0f, alpha};
  }
  const float black = window.center - 0.5f * window.width;
  const float shade = std::clamp((section.value(sampled) - black) / window.width, 0.0f, 1.0f);
  return {Vec3(alpha * shade), alpha};
}

Vec4 draw_pixel(const Section& section, const FaceRays& rays, int x, int y, int samples,
                const FaceStyle& style) {
  PixelSum cinematic(section, rays);
  Vec4 grey(0);
  rays.for_rays(x, y, samples, [&](const FaceRay& ray) {
    if (style.grey < 1) {
      cinematic.add(ray);
    }
    if (style.grey > 0) {
      grey += grey_at(section, rays, ray, style.window);
    }
  });
  const int count = samples * samples;
  return glm::mix(cinematic.color(count), grey / static_cast<float>(count), style.grey);
}

}  // namespace

Image draw_faces(const Section& section, const Camera& camera, const Cut& cut,
                 const FaceOptions& options) {
  Image image(camera.width, camera.height, 4);
  const FaceRays rays(section, camera, cut, options.taps);
  if (!rays.any()) {
    return image;
  }
  const int samples = options.samples > 0 ? options.samples : rays.samples_for_detail();
  parallel_for(static_cast<size_t>(camera.height), 4, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < camera.width; ++x) {
        const Vec4 color = draw_pixel(section, rays, x, y, samples, options.style);
        float* out = image.at(x, y);
        for (int c = 0; c < 4; ++c) {
          out[c] = color[c];
        }
      }
    }
  });
  return image;
}

}  // namespace clipgs
