#include "splat/similarity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/parallel.h"

namespace clipgs {

namespace {

constexpr double kTolerance = 1e-4;
constexpr size_t kSimilarityGrain = 8192;
constexpr int kMaxBand = 2 * kMaxShDegree + 1;

/// Row k, column j of a band's matrix M: Yₖ(Rᵀd) = Σⱼ Mₖⱼ Yⱼ(d) for every direction d.
using BandMatrix = std::array<std::array<double, kMaxBand>, kMaxBand>;

/// Mₖⱼ = ∫ Yₖ(Rᵀd) Yⱼ(d) dd over the sphere. The integrand is a polynomial of degree 6 at most, for
/// which 4 Gauss–Legendre heights times 8 even azimuths are an exact quadrature.
std::array<BandMatrix, kMaxShDegree + 1> sh_rotation(int degree, const glm::dmat3& rotation) {
  constexpr std::array<double, 4> kHeights = {-0.861136311594052575, -0.339981043584856265,
                                              0.339981043584856265, 0.861136311594052575};
  constexpr std::array<double, 4> kWeights = {0.347854845137453857, 0.652145154862546143,
                                              0.652145154862546143, 0.347854845137453857};
  constexpr int kAzimuths = 8;
  std::array<BandMatrix, kMaxShDegree + 1> bands{};
  for (size_t h = 0; h < kHeights.size(); ++h) {
    const double radius = std::sqrt(1 - kHeights[h] * kHeights[h]);
    for (int a = 0; a < kAzimuths; ++a) {
      const double azimuth = 2 * std::numbers::pi * a / kAzimuths;
      const glm::dvec3 d(radius * std::cos(azimuth), radius * std::sin(azimuth), kHeights[h]);
      std::array<float, sh_coefficients(kMaxShDegree)> after{};
      std::array<float, sh_coefficients(kMaxShDegree)> before{};
      sh_basis(degree, Vec3(d), after.data());
      sh_basis(degree, Vec3(glm::transpose(rotation) * d), before.data());
      const double weight = kWeights[h] * 2 * std::numbers::pi / kAzimuths;
      for (int l = 1; l <= degree; ++l) {
        const int first = l * l;
        for (int k = 0; k < 2 * l + 1; ++k) {
          for (int j = 0; j < 2 * l + 1; ++j) {
            bands[l][k][j] += weight * before[first + k] * after[first + j];
          }
        }
      }
    }
  }
  return bands;
}

/// c'ⱼ = Σₖ Mₖⱼ cₖ for every band, channel and Gaussian, of the SH that begin at `first_plane`.
void rotate_sh(const Gaussians& from, int first_plane, int degree, const glm::dmat3& rotation,
               Gaussians& to) {
  for (int p = first_plane; p < first_plane + 3; ++p) {
    std::copy_n(from.plane(p), from.size(), to.plane(p));
  }
  const auto bands = sh_rotation(degree, rotation);
  parallel_for(from.size(), kSimilarityGrain, [&](size_t begin, size_t end) {
    for (int l = 1; l <= degree; ++l) {
      const int count = 2 * l + 1;
      const int first = first_plane + 3 * l * l;
      for (int channel = 0; channel < 3; ++channel) {
        for (int j = 0; j < count; ++j) {
          float* out = to.plane(first + 3 * j + channel);
          for (size_t i = begin; i < end; ++i) {
            double sum = 0;
            for (int k = 0; k < count; ++k) {
              sum += bands[l][k][j] * from.plane(first + 3 * k + channel)[i];
            }
            out[i] = static_cast<float>(sum);
          }
        }
      }
    }
  });
}

}  // namespace

Similarity Similarity::inverse() const {
  Similarity result;
  result.rotation = glm::transpose(rotation);
  result.scale = 1 / scale;
  result.translation = -(result.scale * (result.rotation * translation));
  return result;
}

glm::dmat4 Similarity::matrix() const {
  glm::dmat4 result(scale * rotation);
  result[3] = glm::dvec4(translation, 1);
  return result;
}

Similarity Similarity::from_matrix(const glm::dmat4& matrix) {
  const glm::dmat3 linear(matrix);
  const double determinant = glm::determinant(linear);
  Similarity result;
  result.scale = std::cbrt(determinant);
  result.rotation = linear * (1 / result.scale);
  result.translation = glm::dvec3(matrix[3]);
  const glm::dmat3 product = glm::transpose(result.rotation) * result.rotation;
  double error = 0;
  for (int c = 0; c < 3; ++c) {
    error += glm::length(product[c] - glm::dmat3(1)[c]) + std::abs(matrix[c][3]);
  }
  error += std::abs(matrix[3][3] - 1);
  // Negated, so that NaN fails as well.
  if (!(determinant > 0) || !(error < kTolerance) || !std::isfinite(result.scale) ||
      !std::isfinite(glm::length(result.translation))) {
    throw Error("the world matrix is not a rotation with an even scale and a translation");
  }
  return result;
}

Similarity scene_to_world() {
  Similarity result;
  result.rotation = glm::dmat3(-1, 0, 0,   // x → −R
                               0, 0, -1,   // y → −S
                               0, -1, 0);  // z → −A
  result.scale = 1000;
  return result;
}

Gaussians transform(const Gaussians& gaussians, const Similarity& similarity) {
  Gaussians result = gaussians.like(gaussians.size());
  const auto log_scale = static_cast<float>(std::log(similarity.scale));
  const glm::dquat turn = glm::quat_cast(similarity.rotation);
  parallel_for(gaussians.size(), kSimilarityGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3 mean = similarity.apply(gaussians.mean(i));
      const glm::dquat rotation = turn * glm::dquat(gaussians.rotation(i));
      for (int axis = 0; axis < 3; ++axis) {
        result.plane(Gaussians::kMean + axis)[i] = mean[axis];
        result.plane(Gaussians::kLogScale + axis)[i] =
            gaussians.plane(Gaussians::kLogScale + axis)[i] + log_scale;
      }
      result.plane(Gaussians::kRotation)[i] = static_cast<float>(rotation.w);
      result.plane(Gaussians::kRotation + 1)[i] = static_cast<float>(rotation.x);
      result.plane(Gaussians::kRotation + 2)[i] = static_cast<float>(rotation.y);
      result.plane(Gaussians::kRotation + 3)[i] = static_cast<float>(rotation.z);
      result.plane(Gaussians::kOpacity)[i] = gaussians.plane(Gaussians::kOpacity)[i];
    }
  });
  rotate_sh(gaussians, Gaussians::kSh, gaussians.sh_degree(), similarity.rotation, result);
  if (gaussians.has_face_colors()) {
    rotate_sh(gaussians, gaussians.face(), Gaussians::kFaceDegree, similarity.rotation, result);
  }
  return result;
}

}  // namespace clipgs
