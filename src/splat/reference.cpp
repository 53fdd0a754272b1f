#include "splat/reference.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>

#include "splat/clip.h"
#include "splat/kept_share.h"

namespace clipgs {

namespace {

using DVec2 = glm::dvec2;
using DVec3 = glm::dvec3;
using DMat3 = glm::dmat3;

struct ReferenceSplat {
  DVec2 center;
  glm::dmat2 conic;
  double opacity;
  DVec3 color;
  double depth;
  struct Conditional {
    double distance;  // d(μ)
    DVec2 k;
    double s;
  };
  std::vector<Conditional> cuts;
  std::vector<const Plane*> planes;  // of the cuts
};

/// What planes leave together, each leaving share(k): opposite ones what is between them.
template <typename Share>
double share_of_planes(const std::vector<const Plane*>& planes, const Share& share) {
  double product = 1;
  std::vector<bool> taken(planes.size(), false);
  for (size_t k = 0; k < planes.size(); ++k) {
    if (taken[k]) {
      continue;
    }
    double left = share(k);
    for (size_t other = k + 1; other < planes.size(); ++other) {
      if (!taken[other] && are_opposite(*planes[k], *planes[other])) {
        left = std::max(0.0, left + share(other) - 1);
        taken[other] = true;
        break;
      }
    }
    product *= left;
  }
  return product;
}

double normal_cdf(double x) {
  return 1.0 / (1.0 + std::exp(-(double{kCdfLinear} * x + double{kCdfCubic} * x * x * x)));
}

/// 3DGS's real SH basis in double precision.
void basis(int degree, const DVec3& d, double* y) {
  const double x = d.x, yy = d.y, z = d.z;
  y[0] = 0.28209479177387814;
  if (degree >= 1) {
    y[1] = -0.4886025119029199 * yy;
    y[2] = 0.4886025119029199 * z;
    y[3] = -0.4886025119029199 * x;
  }
  if (degree >= 2) {
    y[4] = 1.0925484305920792 * x * yy;
    y[5] = -1.0925484305920792 * yy * z;
    y[6] = 0.31539156525252005 * (2 * z * z - x * x - yy * yy);
    y[7] = -1.0925484305920792 * x * z;
    y[8] = 0.5462742152960396 * (x * x - yy * yy);
  }
  if (degree >= 3) {
    y[9] = -0.5900435899266435 * yy * (3 * x * x - yy * yy);
    y[10] = 2.890611442640554 * x * yy * z;
    y[11] = -0.4570457994644658 * yy * (4 * z * z - x * x - yy * yy);
    y[12] = 0.3731763325901154 * z * (2 * z * z - 3 * x * x - 3 * yy * yy);
    y[13] = -0.4570457994644658 * x * (4 * z * z - x * x - yy * yy);
    y[14] = 1.445305721320277 * z * (x * x - yy * yy);
    y[15] = -0.5900435899266435 * x * (x * x - 3 * yy * yy);
  }
}

DVec3 gain_at(const FaceGain& gain, const DVec3& normal) {
  double y[FaceGain::kCoefficients];
  basis(FaceGain::kDegree, normal, y);
  DVec3 exponent(0);
  for (size_t k = 0; k < FaceGain::kCoefficients; ++k) {
    exponent += y[k] * DVec3(gain.coefficients[k]);
  }
  return glm::exp(exponent);
}

class ReferenceScene {
 public:
  ReferenceScene(const std::vector<double>& parameters, const Gaussians& shape)
      : p_(parameters), shape_(shape) {}

  double plane(int k, size_t i) const { return p_[static_cast<size_t>(k) * shape_.size() + i]; }

  bool project(size_t i, const Camera& camera, const Cut& cut, const RasterOptions& options,
               ReferenceSplat& out) const {
    const DVec3 mean(plane(0, i), plane(1, i), plane(2, i));
    const DMat3 w(camera.rotation);
    const DVec3 position(camera.position);
    const DVec3 t = w * (mean - position);
    if (t.z <= kNearPlane) {
      return false;
    }
    const glm::dquat q =
        glm::normalize(glm::dquat(plane(6, i), plane(7, i), plane(8, i), plane(9, i)));
    const DMat3 r = glm::mat3_cast(q);
    DMat3 scale2(0);
    for (int a = 0; a < 3; ++a) {
      scale2[a][a] = std::exp(2 * plane(Gaussians::kLogScale + a, i));
    }
    const DMat3 sigma = r * scale2 * glm::transpose(r);

    const double fx = camera.fx, fy = camera.fy;
    const double limit_x = 1.3 * 0.5 * camera.width / fx;
    const double limit_y = 1.3 * 0.5 * camera.height / fy;
    const double lx = std::clamp(t.x / t.z, -limit_x, limit_x);
    const double ly = std::clamp(t.y / t.z, -limit_y, limit_y);
    const glm::dmat3x2 j(fx / t.z, 0, 0, fy / t.z, -fx * lx / t.z, -fy * ly / t.z);
    const glm::dmat3x2 a = j * w;
    const glm::dmat2 cov = a * sigma * glm::transpose(a) + glm::dmat2(double{kBlurVariance});
    out.conic = glm::inverse(cov);
    out.center = {fx * t.x / t.z + camera.cx, fy * t.y / t.z + camera.cy};
    out.depth = t.z;
    out.opacity = 1 / (1 + std::exp(-plane(Gaussians::kOpacity, i)));
    out.cuts.clear();
    out.planes.clear();
    std::vector<double> shares;
    std::vector<const Plane*> planes;
    const bool by_layer = options.clip == ClipOperator::kLayers;
    if (by_layer && options.layers.part(i) == LayerPart::kOff) {
      return false;
    }
    const bool per_pixel = options.clip == ClipOperator::kExact ||
                           (by_layer && options.layers.part(i) == LayerPart::kCut);
    const DVec3 direction = glm::normalize(mean - position);
    DVec3 gain(1);
    DVec3 face(0);
    for (const Plane& plane : cut.planes()) {
      const DVec3 n(plane.normal);
      const double distance = glm::dot(n, mean) - plane.offset;
      const double s_n = std::sqrt(glm::dot(n, sigma * n));
      planes.push_back(&plane);
      const double at_face =
          FaceGain::share(distance / s_n) * FaceGain::facing(glm::dot(n, direction));
      gain *= DVec3(1) + at_face * (gain_at(options.face_gain, n) - DVec3(1));
      if (shape_.has_face_colors()) {
        face += at_face * face_color(i, n);
      }
      shares.push_back(std::clamp(0.5 + distance / (2 * s_n), 0.0, 1.0));
      if (options.clip == ClipOperator::kHard && distance < 0) {
        return false;
      }
      if (per_pixel) {
        if (distance < -options.clip_sigma * s_n) {
          return false;
        }
        if (distance < options.clip_sigma * s_n) {
          const DVec2 c = a * (sigma * n);
          const DVec2 k = out.conic * c;
          out.planes.push_back(&plane);
          out.cuts.push_back({distance, k,
                              std::sqrt(std::max(s_n * s_n - glm::dot(c, k),
                                                 double{kMinConditionalVariance} * s_n * s_n))});
        }
      }
    }
    if (options.clip == ClipOperator::kSoft) {
      out.opacity *= share_of_planes(planes, [&](size_t k) { return shares[k]; });
    }
    const double kept = options.cue.kept(static_cast<float>(glm::length(mean - position)));
    double y[sh_coefficients(kMaxShDegree)];
    basis(shape_.sh_degree(), direction, y);
    for (int c = 0; c < 3; ++c) {
      double value = 0.5;
      for (int k = 0; k < sh_coefficients(shape_.sh_degree()); ++k) {
        value += y[k] * plane(Gaussians::kSh + 3 * k + c, i);
      }
      out.color[c] = kept * std::max(0.0, (value + face[c]) * gain[c]);
    }
    return true;
  }

 private:
  DVec3 face_color(size_t i, const DVec3& normal) const {
    double y[sh_coefficients(Gaussians::kFaceDegree)];
    basis(Gaussians::kFaceDegree, normal, y);
    DVec3 color(0);
    for (int p = 0; p < Gaussians::kFacePlanes; ++p) {
      color[p % 3] += y[p / 3] * plane(shape_.face() + p, i);
    }
    return color;
  }

  const std::vector<double>& p_;
  const Gaussians& shape_;
};

}  // namespace

std::vector<double> reference_render(const std::vector<double>& parameters, const Gaussians& shape,
                                     const Camera& camera, const Cut& cut,
                                     const RasterOptions& options) {
  const ReferenceScene scene(parameters, shape);
  std::vector<ReferenceSplat> splats;
  for (size_t i = 0; i < shape.size(); ++i) {
    ReferenceSplat splat{};
    if (scene.project(i, camera, cut, options, splat)) {
      splats.push_back(splat);
    }
  }
  std::ranges::stable_sort(splats, {}, [](const auto& splat) { return splat.depth; });

  const KeptShare share = options.kept_share ? KeptShare(camera, cut, shape) : KeptShare();
  std::vector<double> image(static_cast<size_t>(camera.width) * camera.height * 4, 0.0);
  for (int py = 0; py < camera.height; ++py) {
    for (int px = 0; px < camera.width; ++px) {
      double* out = &image[(static_cast<size_t>(py) * camera.width + px) * 4];
      double transmittance = 1;
      for (const ReferenceSplat& s : splats) {
        const DVec2 delta = DVec2(px + 0.5, py + 0.5) - s.center;
        double alpha = s.opacity * std::exp(-0.5 * glm::dot(delta, s.conic * delta));
        alpha *= share_of_planes(s.planes, [&](size_t k) {
          const auto& e = s.cuts[k];
          return normal_cdf((e.distance + glm::dot(e.k, delta)) / e.s);
        });
        alpha = std::min(alpha, double{options.alpha_max});
        if (alpha < options.alpha_min || transmittance < options.transmittance_min) {
          continue;
        }
        for (int c = 0; c < 3; ++c) {
          out[c] += s.color[c] * alpha * transmittance;
        }
        transmittance *= 1 - alpha;
      }
      out[3] = 1 - transmittance;
      std::transform(out, out + 4, out, [&](double v) { return double{share.at(px, py)} * v; });
    }
  }
  return image;
}

}  // namespace clipgs
