#pragma once

#include <cstddef>
#include <vector>

#include "core/geometry.h"

namespace clipgs {

constexpr int kMaxShDegree = 3;
constexpr float kShBand0 = 0.28209479177387814f;  ///< Y₀, the constant spherical harmonic
/// Coefficients per colour channel at an SH degree: (degree + 1)².
constexpr int sh_coefficients(int degree) { return (degree + 1) * (degree + 1); }

/// A cloud of 3D Gaussians as a structure of arrays: one plane of `size()` floats per parameter.
///
///   plane   0–2   mean x, y, z (world, mm)
///           3–5   log of the standard deviations along the local axes (mm)
///           6–9   rotation quaternion w, x, y, z (need not be normalised)
///           10    opacity as a logit
///           11…   SH coefficients, plane kSh + 3·coefficient + channel
///                 (colour = 0.5 + Σ Yₖ·cₖ in display sRGB, as 3DGS does)
///           last  face colours, if there are any: plane face() + 3·coefficient + channel. What a
///                 cut adds to the colour by its plane's normal n, Σ Yₖ(n)·cₖ (method.md §12)
class Gaussians {
 public:
  enum Plane { kMean = 0, kLogScale = 3, kRotation = 6, kOpacity = 10, kSh = 11 };
  static constexpr int kFaceDegree = 1;  ///< of the SH of face colours
  static constexpr int kFacePlanes = 3 * sh_coefficients(kFaceDegree);

  Gaussians() = default;
  Gaussians(size_t size, int sh_degree, bool face_colors = false)
      : size_(size),
        sh_degree_(sh_degree),
        face_colors_(face_colors),
        data_(size * static_cast<size_t>(planes()), 0.0f) {}

  size_t size() const { return size_; }
  int sh_degree() const { return sh_degree_; }
  bool has_face_colors() const { return face_colors_; }
  /// Of a cloud without face colours.
  static constexpr int planes(int degree) { return kSh + 3 * sh_coefficients(degree); }
  int planes() const { return face() + (face_colors_ ? kFacePlanes : 0); }
  /// The first plane of face colours.
  int face() const { return planes(sh_degree_); }

  float* plane(int p) { return data_.data() + static_cast<size_t>(p) * size_; }
  const float* plane(int p) const { return data_.data() + static_cast<size_t>(p) * size_; }
  std::vector<float>& data() { return data_; }
  const std::vector<float>& data() const { return data_; }

  Vec3 mean(size_t i) const { return {plane(0)[i], plane(1)[i], plane(2)[i]}; }
  /// Standard deviations, mm.
  Vec3 scale(size_t i) const;
  /// Unit quaternion.
  Quat rotation(size_t i) const;
  /// R S² Rᵀ, mm².
  Mat3 covariance(size_t i) const;
  /// In (0, 1).
  float opacity(size_t i) const;

  /// The Gaussians named by `order`, in that order.
  Gaussians gather(const std::vector<size_t>& order) const;
  /// `size` Gaussians with the same planes, all 0.
  Gaussians like(size_t size) const { return Gaussians(size, sh_degree_, face_colors_); }
  bool is_like(const Gaussians& other) const {
    return sh_degree_ == other.sh_degree_ && face_colors_ == other.face_colors_;
  }
  /// These with SH of another degree, and with or without face colours: higher coefficients are
  /// dropped, new ones are 0.
  Gaussians reshaped(int sh_degree, bool face_colors) const;

 private:
  size_t size_ = 0;
  int sh_degree_ = 0;
  bool face_colors_ = false;
  std::vector<float> data_;  // [planes, size]
};

/// Real SH basis of 3DGS (Kerbl 2023) at unit `direction`; writes sh_coefficients(degree) values.
void sh_basis(int degree, const Vec3& direction, float* values);

}  // namespace clipgs
