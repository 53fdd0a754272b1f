#include "measure/cut_face.h"

#include <algorithm>
#include <cmath>

#include "measure/metrics.h"

namespace clipgs {
namespace {

constexpr float kShown = 0.04f;          // brightness of what counts as shown
constexpr float kChanged = 0.04f;        // of luminance
constexpr float kEdgeBand = 12;          // px
constexpr float kLeakMargin = 2;         // px: of the edge itself
constexpr float kLeakWindow = 60;        // px
constexpr double kMeansC = 0.01 * 0.01;  // of SSIM
constexpr double kSpreadsC = 0.03 * 0.03;
constexpr double kStraight = 1e-6;  // of a line's slope: there is none

struct Shown {
  Image rgb;  // over black

  explicit Shown(const Image& picture) : rgb(composite(picture, 0, 0, 0)) {}
  float brightness(size_t i) const {
    return std::max({rgb.data[3 * i], rgb.data[3 * i + 1], rgb.data[3 * i + 2]});
  }
  float luminance(size_t i) const {
    return (rgb.data[3 * i] + rgb.data[3 * i + 1] + rgb.data[3 * i + 2]) / 3;
  }
  bool at(size_t i) const { return brightness(i) > kShown; }
};

/// SSIM of luminance, one window over what the truth shows.
std::optional<double> face_ssim(const Shown& truth, const Shown& picture) {
  double count = 0;
  double sum_a = 0;
  double sum_b = 0;
  double sum_aa = 0;
  double sum_bb = 0;
  double sum_ab = 0;
  for (size_t i = 0; i < truth.rgb.pixels(); ++i) {
    if (truth.at(i)) {
      const double a = truth.luminance(i);
      const double b = picture.luminance(i);
      ++count;
      sum_a += a;
      sum_b += b;
      sum_aa += a * a;
      sum_bb += b * b;
      sum_ab += a * b;
    }
  }
  if (count < 2) {
    return std::nullopt;
  }
  const double a = sum_a / count;
  const double b = sum_b / count;
  const double var_a = sum_aa / count - a * a;
  const double var_b = sum_bb / count - b * b;
  const double covariance = sum_ab / count - a * b;
  return (2 * a * b + kMeansC) * (2 * covariance + kSpreadsC) /
         ((a * a + b * b + kMeansC) * (var_a + var_b + kSpreadsC));
}

/// What the cut changes of the pixels that `counts(i)` is true of.
template <typename Counts>
CutChange change_of(const CutView& view, const Shown& truth, const Shown& picture,
                    const Counts& counts) {
  const Shown uncut_truth(view.uncut_truth);
  const Shown uncut_picture(view.uncut_picture);
  CutChange change;
  for (size_t i = 0; i < truth.rgb.pixels(); ++i) {
    if (counts(i)) {
      const bool should = std::abs(uncut_truth.luminance(i) - truth.luminance(i)) > kChanged;
      const bool does = std::abs(uncut_picture.luminance(i) - picture.luminance(i)) > kChanged;
      change.changed += should ? 1 : 0;
      change.missed += should && !does ? 1 : 0;
      change.extra += does && !should ? 1 : 0;
    }
  }
  return change;
}

}  // namespace

void CutChange::add(const CutChange& other) {
  missed += other.missed;
  extra += other.extra;
  changed += other.changed;
}

std::optional<double> CutChange::percent() const {
  return changed > 0 ? std::optional(100.0 * static_cast<double>(missed + extra) /
                                     static_cast<double>(changed))
                     : std::nullopt;
}

void CutFace::add(const CutFace& other) {
  ssim_sum += other.ssim_sum;
  faces += other.faces;
  leaked += other.leaked;
  near_edge += other.near_edge;
  edge.add(other.edge);
  face.add(other.face);
}

std::optional<double> CutFace::ssim() const {
  return faces > 0 ? std::optional(ssim_sum / static_cast<double>(faces)) : std::nullopt;
}

std::optional<double> CutFace::leak_percent() const {
  return near_edge > 0 ? std::optional(100 * leaked / near_edge) : std::nullopt;
}

Image distance_from_edge(const Camera& camera, const Plane& plane, const Sphere& sphere) {
  using M = glm::dmat3;
  using V = glm::dvec3;
  // Rows of the 3 × 4 matrix P that takes points, in radii from the sphere's middle, to pixels.
  const M intrinsics(V(camera.fx, 0, 0), V(0, camera.fy, 0), V(camera.cx, camera.cy, 1));
  const M left = intrinsics * M(camera.rotation);
  const V right = -(left * (V(camera.position - sphere.center) / double{sphere.radius}));
  const V normal(plane.normal);
  const double offset = (plane.offset - glm::dot(normal, V(sphere.center))) / double{sphere.radius};
  // l = (P·Pᵀ)⁻¹·P·(n, −offset) has the least |Pᵀ·l − (n, −offset)|.
  const M square = left * glm::transpose(left) + glm::outerProduct(right, right);
  V line = glm::inverse(square) * (left * normal - offset * right);
  const double slope = std::hypot(line.x, line.y);
  Image distances(camera.width, camera.height, 1);
  if (slope < kStraight) {
    return distances;
  }
  // Towards where the plane keeps, as the picture has that.
  const V kept = M(camera.rotation) * normal;
  const double towards = line.x * camera.fx * kept.x + line.y * camera.fy * kept.y;
  line *= (towards > 0 ? -1 : 1) / slope;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      *distances.at(x, y) = static_cast<float>(glm::dot(line, V(x + 0.5, y + 0.5, 1)));
    }
  }
  return distances;
}

CutFace cut_face(const CutView& view, const Sphere& sphere) {
  for (const Image* other : {&view.uncut_truth, &view.picture, &view.uncut_picture}) {
    require_same_size(view.truth, *other);
  }
  const Shown truth(view.truth);
  const Shown picture(view.picture);
  CutFace result;
  if (view.plane.signed_distance(view.camera.position) < 0) {
    if (const std::optional<double> ssim = face_ssim(truth, picture)) {
      result.ssim_sum = *ssim;
      result.faces = 1;
    }
    result.face = change_of(view, truth, picture, [](size_t) { return true; });
    return result;
  }
  const Image distances = distance_from_edge(view.camera, view.plane, sphere);
  for (size_t i = 0; i < truth.rgb.pixels(); ++i) {
    const float distance = distances.data[i];
    if (std::abs(distance) <= kLeakWindow && picture.at(i)) {
      result.near_edge += picture.brightness(i);
      result.leaked += distance > kLeakMargin && !truth.at(i) ? picture.brightness(i) : 0;
    }
  }
  result.edge = change_of(view, truth, picture,
                          [&](size_t i) { return std::abs(distances.data[i]) <= kEdgeBand; });
  return result;
}

}  // namespace clipgs
