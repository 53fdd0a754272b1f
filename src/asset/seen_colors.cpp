#include "asset/seen_colors.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "asset/draw_case.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "section/faces.h"

namespace clipgs {

namespace {

constexpr int kViews = 32;
constexpr int kMostPixels = 768;  // a side
constexpr int kLeastPixels = 64;
constexpr float kGrazing = 0.15f;    // cosine below which a disc is not looked at
constexpr float kBehind = 3;         // deviations behind the nearest disc that are still seen
constexpr float kLeastAlpha = 0.5f;  // of a face that hides what is behind it …
constexpr float kLeastSeen = 0.2f;   // … and of a disc that is kept: thin matter has less than one
constexpr float kFar = 1e9f;
// How much a disc is held to look the same from all sides: as much as by so many views.
constexpr float kSame = 0.3f;

using Coefficients = Eigen::Matrix<float, 4, 3>;

/// A disc in a picture.
struct Place {
  int x, y;
  float distance;  // along the view, mm
  float reach;     // px
};

struct Seen {
  Vec3 color;  // straight display sRGB
  float alpha;
};

/// A picture of a case, and how far away the nearest face or disc of each pixel is.
class Look {
 public:
  Look(const Case& contents, const Cut& cut, const Gaussians& discs, const Camera& camera)
      : camera_(camera),
        picture_(draw_case(contents, camera, cut)),
        nearest_(camera.width, camera.height, 1) {
    const Image faces = draw_faces(*contents.section, camera, cut);
    const Image distances = face_distances(*contents.section, camera, cut);
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const Vec3 ray =
            camera.ray_direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        const float face = *distances.at(x, y) * glm::dot(ray, camera.forward());
        *nearest_.at(x, y) = faces.at(x, y)[3] > kLeastAlpha ? face : kFar;
      }
    }
    for (size_t i = 0; i < discs.size(); ++i) {
      if (const std::optional<Place> place = place_of(discs, i)) {
        cover(*place);
      }
    }
  }

  /// Nothing where a disc is hidden.
  std::optional<Seen> at(const Gaussians& discs, size_t i) const {
    const std::optional<Place> place = place_of(discs, i);
    if (!place || place->distance > *nearest_.at(place->x, place->y) + kBehind * discs.scale(i).x) {
      return std::nullopt;
    }
    const float* const pixel = picture_.at(place->x, place->y);
    return Seen{Vec3(pixel[0], pixel[1], pixel[2]), pixel[3]};
  }

  const Vec3& eye() const { return camera_.position; }

 private:
  std::optional<Place> place_of(const Gaussians& discs, size_t i) const {
    const Vec3 at = camera_.to_camera(discs.mean(i));
    const Vec2 pixel =
        Vec2(camera_.fx, camera_.fy) * Vec2(at) / at.z + Vec2(camera_.cx, camera_.cy);
    const bool inside = at.z > 0 && pixel.x >= 0 && pixel.y >= 0 &&
                        pixel.x < static_cast<float>(camera_.width) &&
                        pixel.y < static_cast<float>(camera_.height);
    if (!inside) {
      return std::nullopt;
    }
    return Place{static_cast<int>(pixel.x), static_cast<int>(pixel.y), at.z,
                 discs.scale(i).x * camera_.fx / at.z};
  }

  void cover(const Place& place) {
    const int reach = static_cast<int>(std::ceil(place.reach));
    for (int y = std::max(0, place.y - reach); y <= std::min(camera_.height - 1, place.y + reach);
         ++y) {
      for (int x = std::max(0, place.x - reach); x <= std::min(camera_.width - 1, place.x + reach);
           ++x) {
        *nearest_.at(x, y) = std::min(*nearest_.at(x, y), place.distance);
      }
    }
  }

  Camera camera_;
  Image picture_;
  Image nearest_;
};

/// Least squares of a disc's colour over what pictures show of it.
class Fit {
 public:
  void add(const Vec3& direction, const Seen& seen, float weight) {
    Eigen::Vector4f basis;
    sh_basis(1, direction, basis.data());
    const Vec3 color = seen.color - 0.5f;
    squares_ += weight * seen.alpha * basis * basis.transpose();
    products_ += weight * seen.alpha * basis * Eigen::RowVector3f(color.r, color.g, color.b);
    weight_ += weight;
    alpha_ += weight * seen.alpha;
  }

  bool is_seen() const { return weight_ > 0; }
  /// How much it hides of what is behind it, 0…1.
  float alpha() const { return alpha_ / weight_; }

  /// SH coefficients; those above `sh_degree` are 0.
  Coefficients solve(int sh_degree) const {
    Coefficients solution = Coefficients::Zero();
    if (sh_degree == 0) {
      solution.row(0) = products_.row(0) / squares_(0, 0);
      return solution;
    }
    Eigen::Matrix4f held = squares_;
    held.diagonal().tail<3>().array() += kSame;
    return held.ldlt().solve(products_);
  }

 private:
  Eigen::Matrix4f squares_ = Eigen::Matrix4f::Zero();
  Coefficients products_ = Coefficients::Zero();
  float weight_ = 0;
  float alpha_ = 0;
};

std::vector<Fit> look_around(const Case& contents, const Cut& cut, const Gaussians& discs) {
  std::vector<Fit> fits(discs.size());
  if (fits.empty()) {
    return fits;
  }
  const Sphere& sphere = contents.scene.sphere;
  const int size = std::clamp(static_cast<int>(2 * sphere.radius / (kFrameFill * discs.scale(0).x)),
                              kLeastPixels, kMostPixels);
  Progress progress("colours of surfaces", kViews);
  for (int view = 0; view < kViews; ++view) {
    const Camera camera = frame_sphere(sphere, fibonacci_sphere(view, kViews), 1, size, size);
    const Look look(contents, cut, discs, camera);
    constexpr size_t kGrain = 4096;
    parallel_for(discs.size(), kGrain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const Vec3 ray = glm::normalize(discs.mean(i) - look.eye());
        const float cosine = -glm::dot(ray, glm::mat3_cast(discs.rotation(i))[2]);
        const std::optional<Seen> seen = cosine > kGrazing ? look.at(discs, i) : std::nullopt;
        if (seen) {
          fits[i].add(ray, *seen, cosine * cosine);
        }
      }
    });
    progress.update(static_cast<size_t>(view) + 1);
  }
  return fits;
}

}  // namespace

Gaussians in_seen_colors(const Case& contents, const Cut& cut, const Gaussians& discs, size_t lit,
                         int sh_degree) {
  const std::vector<Fit> fits = look_around(contents, cut, discs);
  std::vector<size_t> kept;
  for (size_t i = 0; i < fits.size(); ++i) {
    if (fits[i].is_seen() ? fits[i].alpha() > kLeastSeen : i < lit) {
      kept.push_back(i);
    }
  }
  Gaussians colored = discs.gather(kept).reshaped(sh_degree, false);
  for (size_t i = 0; i < kept.size(); ++i) {
    const Fit& fit = fits[kept[i]];
    if (!fit.is_seen()) {
      continue;
    }
    const Coefficients solution = fit.solve(sh_degree);
    for (int k = 0; k < sh_coefficients(sh_degree); ++k) {
      for (int c = 0; c < 3; ++c) {
        colored.plane(Gaussians::kSh + 3 * k + c)[i] = solution(k, c);
      }
    }
    const float opacity = fit.alpha() * colored.opacity(i);
    colored.plane(Gaussians::kOpacity)[i] = std::log(opacity / (1 - opacity));
  }
  return colored;
}

}  // namespace clipgs
