#include "section/faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "section/display_curve.h"
#include "section/face_light.h"
#include "section/face_rays.h"
#include "section/openings.h"

namespace clipgs {
namespace {

/// Linear RGB, of neutral walls behind grey faces: grey is for values.
const Vec3 kClay(0.16f, 0.26f, 0.42f);

/// The walls behind a picture's openings.
class PictureOpenings {
 public:
  PictureOpenings(const Section& section, const OpenedLight* light, const Camera& camera,
                  const Cut& cut)
      : section_(section),
        light_(light != nullptr && light->openings().drawn() && !cut.empty() ? light : nullptr),
        eye_(camera.position) {}

  /// Whether a gap of a face opens at an index: not where it comes from the air around the body.
  bool are_at(const Vec3& entry) const {
    return light_ != nullptr && light_->openings().is_inside(entry);
  }

  /// The wall that a ray meets beyond `from` mm, if it meets one.
  std::optional<Wall> look(const FaceRay& ray, float from) const {
    return light_->openings().first_wall(section_, eye_, ray.direction, from, ray.leave);
  }
  Vec3 light_on(const Wall& wall) const { return light_->on(wall); }

 private:
  const Section& section_;
  const OpenedLight* light_;
  Vec3 eye_;
};

/// How much of a face is inside the body, in grey: codes between those of the air around it and of
/// all else come from interpolation.
float inside_share(float code) {
  constexpr float kLow = 0.25f * Section::kFirstInside;
  constexpr float kHigh = 0.75f * Section::kFirstInside;
  return std::clamp((code - kLow) / (kHigh - kLow), 0.0f, 1.0f);
}

/// A value as grey: 0 black … 1 white, beyond them outside the window.
float shade(float value, const Window& window) {
  const float black = window.center - 0.5f * window.width;
  return (value - black) / window.width;
}

/// Sums what the rays of one pixel see.
class PixelSum {
 public:
  PixelSum(const Section& section, const FaceRays& rays, const PictureOpenings& openings,
           const FaceStyle& style)
      : section_(section),
        rays_(rays),
        openings_(openings),
        style_(style),
        display_(display_curve(section.tone)) {}

  void add(const FaceRay& ray) {
    const Vec3 entry = rays_.index_at(ray, ray.enter);
    const bool marches = style_.grey < 1 || style_.openings != FaceStyle::Openings::kValues;
    const float open = marches ? add_cinematic(ray, entry) : 0;
    if (style_.grey > 0) {
      grey_ += (1 - open) * grey_at(entry);
    }
  }

  /// Premultiplied display sRGB and alpha, for `count` rays, some of which met no face.
  Vec4 color(int count) {
    finish_gloss();
    const Vec4 sum = glm::mix(shown(seen_), grey_, style_.grey) + shown(behind_);
    return sum / static_cast<float>(count);
  }

 private:
  struct Seen {
    Vec3 light{0};
    float alpha = 0;

    void add(float weight, const Vec3& radiance) {
      light += weight * radiance;
      alpha += weight;
    }
  };

  /// Returns how much of the ray grey shows no values of, for it goes on through a gap.
  float add_cinematic(const FaceRay& ray, const Vec3& entry) {
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
    const March march = rays_.march(ray, visit);
    seen_.alpha += march.alpha;
    seen_.light += light * face_->light;
    if (!march.gap || !openings_.are_at(entry)) {
      return 0;
    }
    const std::optional<Wall> wall = openings_.look(ray, *march.gap);
    if (!wall) {
      return 0;
    }
    const float open = openness(1 - march.alpha, entry);
    const Vec3 incoming = openings_.light_on(*wall);
    const bool is_clay = style_.openings == FaceStyle::Openings::kNeutral;
    const Vec3 behind = glm::mix(wall->reflectance, kClay, is_clay ? style_.grey : 0);
    seen_.add((1 - open) * (1 - march.alpha), wall->reflectance * incoming);
    behind_.add(open * (1 - (1 - style_.grey) * march.alpha), behind * incoming);
    return open;
  }

  /// How much of what is behind a gap is seen in grey, where `share` of a ray's light goes on.
  float openness(float share, const Vec3& entry) const {
    if (style_.grey <= 0 || style_.openings == FaceStyle::Openings::kValues) {
      return 0;
    }
    constexpr float kGap = 0.4f;       // less is tissue …
    constexpr float kClearGap = 0.6f;  // … and more an opening
    const float gap = std::clamp((share - kGap) / (kClearGap - kGap), 0.0f, 1.0f);
    if (section_.channels == 3) {
      return gap;
    }
    constexpr float kDark = 0.1f;  // of the window, below black: brighter is a value
    const float value = section_.value(section_.sample(entry));
    return gap * std::clamp(-shade(value, style_.window) / kDark, 0.0f, 1.0f);
  }

  /// What a ray meets on the face in grey: premultiplied display sRGB and alpha.
  Vec4 grey_at(const Vec3& index) const {
    const Vec3 sampled = section_.sample(index);
    const float alpha = inside_share(section_.code(index));
    if (section_.channels == 3) {
      return {alpha * sampled / 255.0f, alpha};
    }
    const float value = std::clamp(shade(section_.value(sampled), style_.window), 0.0f, 1.0f);
    return {Vec3(alpha * value), alpha};
  }

  /// Premultiplied display sRGB and alpha of a sum.
  Vec4 shown(const Seen& seen) const {
    if (seen.alpha <= 0) {
      return Vec4(0);
    }
    const Vec3 light = section_.exposure / seen.alpha * seen.light;
    return seen.alpha * Vec4(display_(light.r), display_(light.g), display_(light.b), 1);
  }

  // Gloss changes slowly: one lobe, of the mean roughness, is right for a pixel's part of a face.
  void finish_gloss() {
    if (specular_ > 0) {
      seen_.light +=
          specular_ * face_gloss(section_.rig, face_->outward, out_, roughness_ / specular_);
    }
    specular_ = 0;
    roughness_ = 0;
  }

  const Section& section_;
  const FaceRays& rays_;
  const PictureOpenings& openings_;
  const FaceStyle& style_;
  const DisplayCurve& display_;
  const Face* face_ = nullptr;
  Vec3 out_{0};  // towards the camera
  Seen seen_;    // of tissue, and of walls where the face is not grey
  Seen behind_;  // of walls behind a grey face
  Vec4 grey_{0};
  float specular_ = 0;   // weights of the face's gloss …
  float roughness_ = 0;  // … and their sum with its roughness
};

Vec4 draw_pixel(const Section& section, const FaceRays& rays, const PictureOpenings& openings,
                int x, int y, int count, const FaceStyle& style) {
  PixelSum sum(section, rays, openings, style);
  rays.for_rays(x, y, count, [&](const FaceRay& ray) { sum.add(ray); });
  return sum.color(count);
}

/// Whether a pixel differs visibly from one beside it.
bool has_edge(const Image& image, int x, int y) {
  constexpr float kVisible = 0.05f;  // of the display's range
  const auto differs = [&](int other_x, int other_y) {
    if (other_x < 0 || other_y < 0 || other_x >= image.width || other_y >= image.height) {
      return false;
    }
    const float* a = image.at(x, y);
    const float* b = image.at(other_x, other_y);
    return std::abs(a[0] - b[0]) > kVisible || std::abs(a[1] - b[1]) > kVisible ||
           std::abs(a[2] - b[2]) > kVisible || std::abs(a[3] - b[3]) > kVisible;
  };
  return differs(x - 1, y) || differs(x + 1, y) || differs(x, y - 1) || differs(x, y + 1);
}

/// 1 for the pixels of a box that have edges, row by row.
std::vector<std::uint8_t> find_edges(const Image& image, const PixelBox& box) {
  const glm::ivec2 size = glm::max(box.high - box.low, glm::ivec2(0));
  std::vector<std::uint8_t> edges(static_cast<size_t>(size.x) * size.y);
  parallel_for(static_cast<size_t>(size.y), 16, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      for (int x = 0; x < size.x; ++x) {
        const bool edge = has_edge(image, box.low.x + x, box.low.y + static_cast<int>(row));
        edges[row * size.x + x] = edge ? 1 : 0;
      }
    }
  });
  return edges;
}

}  // namespace

FaceStyle::Openings parse_grey_openings(const std::string& name) {
  constexpr std::array<const char*, 3> kNames = {"cinematic", "neutral", "values"};
  for (size_t i = 0; i < kNames.size(); ++i) {
    if (name == kNames[i]) {
      return static_cast<FaceStyle::Openings>(i);
    }
  }
  throw Error("openings \"{}\" do not exist; choose cinematic, neutral or values", name);
}

Image draw_faces(const Section& section, const Camera& camera, const Cut& cut,
                 const FaceOptions& options) {
  Image image(camera.width, camera.height, 4);
  const FaceRays rays(section, camera, cut, options.taps);
  if (!rays.any()) {
    return image;
  }
  const PixelBox box = rays.covered();
  const PictureOpenings openings(section, options.light, camera, cut);
  // draw(count, wanted): the wanted pixels, by `count` rays each.
  const auto draw = [&](int count, const auto& wanted) {
    const auto rows = static_cast<size_t>(std::max(0, box.high.y - box.low.y));
    parallel_for(rows, 4, [&](size_t begin, size_t end) {
      for (size_t row = begin; row < end; ++row) {
        const int y = box.low.y + static_cast<int>(row);
        for (int x = box.low.x; x < box.high.x; ++x) {
          if (wanted(x, y)) {
            const Vec4 color = draw_pixel(section, rays, openings, x, y, count, options.style);
            std::copy_n(&color[0], 4, image.at(x, y));
          }
        }
      }
    });
  };
  draw(std::max(1, options.rays), [](int, int) { return true; });
  if (options.rays == 0) {
    const std::vector<std::uint8_t> edges = find_edges(image, box);
    draw(FaceOptions::kMostRays, [&](int x, int y) {
      return edges[static_cast<size_t>(y - box.low.y) * (box.high.x - box.low.x) + x - box.low.x] !=
             0;
    });
  }
  return image;
}

Image face_distances(const Section& section, const Camera& camera, const Cut& cut) {
  Image image(camera.width, camera.height, 1);
  const FaceRays rays(section, camera, cut, FaceOptions().taps);
  if (!rays.any()) {
    return image;
  }
  const PixelBox box = rays.covered();
  for (int y = box.low.y; y < box.high.y; ++y) {
    for (int x = box.low.x; x < box.high.x; ++x) {
      float sum = 0;
      int count = 0;
      rays.for_rays(x, y, FaceOptions::kMostRays, [&](const FaceRay& ray) {
        sum += ray.enter;
        ++count;
      });
      *image.at(x, y) = count > 0 ? sum / static_cast<float>(count) : 0;
    }
  }
  return image;
}

}  // namespace clipgs
