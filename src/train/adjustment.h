#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry.h"

namespace clipgs {

/// The shape of the adaptive adjustment model (ClipGS).
struct AdjustmentOptions {
  int position_octaves = 6;  ///< of the encoding of a centre: wavelengths 2 to 2⁻⁴ of the radius
  int plane_octaves = 8;     ///< … of the plane's position: 2 to 2⁻⁶ of the radius
  int width = 64;            ///< neurons of a hidden layer; a multiple of 16
  int hidden_layers = 3;
  /// Share of the extent along the axis, to either side of the plane, in which Gaussians are
  /// adjusted; 0: everywhere.
  float window = 0.08f;
  /// Whether the model also sees each Gaussian's shape and how deep the plane cuts it; without, it
  /// sees what ClipGS's does, centre and plane position.
  bool shape = true;

  bool operator==(const AdjustmentOptions&) const = default;
};

/// What the model sees of one Gaussian.
struct AdjustmentInput {
  Vec3 center;
  float distance;  ///< of the centre from the plane, mm, positive on the kept side
  Vec3 log_scale;  ///< of the standard deviations in mm
  Vec3 along;      ///< squares of the plane's normal in the Gaussian's own axes; they sum to 1
};

/// What the model adds to one Gaussian: mean (mm), logarithms of the scales, quaternion (w x y z).
struct Adjusted {
  float mean[3];
  float log_scale[3];
  float rotation[4];
};

/// ClipGS's adaptive adjustment model (method.md §9): a multilayer perceptron from sin/cos
/// encodings of a Gaussian's centre and of the plane's position to what is added to its mean,
/// scales and rotation. It starts as the identity: the output layer is 0.
class Adjustment {
 public:
  Adjustment() = default;
  /// `sphere`: of the visible matter, the unit of positions. `extent`: of the matter along the
  /// axis, mm, the unit of the window.
  Adjustment(const AdjustmentOptions& options, const Sphere& sphere, float extent,
             std::uint64_t seed);

  const AdjustmentOptions& options() const { return options_; }
  /// Layer by layer: weights [out, in], then biases [out], sizes rounded up to multiples of 16.
  /// What the rounding adds is 0 and stays so.
  std::vector<float>& weights() { return weights_; }
  const std::vector<float>& weights() const { return weights_; }

  /// How much of the model's output a Gaussian takes whose centre is `distance` mm from the plane:
  /// 1 at the plane, 0 from the window's edge on, once differentiable.
  float share(float distance) const;

  /// What is added to each Gaussian.
  void forward(std::span<const AdjustmentInput> inputs, std::span<Adjusted> added) const;

  /// Given ∂L/∂added, writes ∂L/∂weights. The inputs count as constants: Gaussians are taught by
  /// what the splats show, not by what the model makes of them.
  void backward(std::span<const AdjustmentInput> inputs, std::span<const Adjusted> gradient,
                std::vector<float>& weight_gradient) const;

 private:
  struct Layer {
    size_t in, out;  // padded
    size_t begin;    // of its weights; biases follow them
  };
  struct Scratch;

  void encode(const AdjustmentInput& input, float* out) const;
  void run(Scratch& scratch, std::span<const AdjustmentInput> inputs) const;
  void start_backward(Scratch& scratch, std::span<const AdjustmentInput> inputs,
                      std::span<const Adjusted> gradient) const;
  void backward_layer(Scratch& scratch, size_t l, size_t points, std::vector<float>& sum) const;
  float mean_unit(const AdjustmentInput& input) const;
  std::vector<float> transposed_weights() const;

  AdjustmentOptions options_;
  Sphere sphere_;
  float extent_ = 1;
  std::vector<Layer> layers_;
  std::vector<float> weights_;
};

/// The same as Adjustment::forward, in double precision and without kernels: what the fast one is
/// held to. `weights`: as Adjustment::weights().
std::vector<double> reference_adjustment(const AdjustmentOptions& options, const Sphere& sphere,
                                         float extent, std::span<const double> weights,
                                         const AdjustmentInput& input);

}  // namespace clipgs
