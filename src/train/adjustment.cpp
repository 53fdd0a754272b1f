#include "train/adjustment.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "core/random.h"
#include "train/adjustment_kernel.h"

namespace clipgs {

namespace {

constexpr size_t kOutputs = sizeof(Adjusted) / sizeof(float);
constexpr size_t kPoints = 64;            // of a block: its activations stay in the first cache
constexpr size_t kAdjustmentGrain = 512;  // points whose weight gradients are summed apart
// Without shapes a mean moves by this share of the radius where a scale changes by a factor e, so
// that one learning rate suits both.
constexpr float kMeanUnit = 0.01f;

size_t padded(size_t n) { return (n + kMatrixStep - 1) / kMatrixStep * kMatrixStep; }

/// How a plane cuts one Gaussian: numbers that encode it beside centre and plane position.
struct Shape {
  static constexpr size_t kCount = 8;
  static constexpr double kDeepest = 4;  // standard deviations; deeper makes no difference
  double deviation;                      // s_n along the plane's normal, mm
  double depth;                          // distance / s_n
};

Shape shape_of(const AdjustmentInput& input) {
  double variance = 0;
  for (int a = 0; a < 3; ++a) {
    variance += input.along[a] * std::exp(2.0 * input.log_scale[a]);
  }
  const double deviation = std::sqrt(variance);
  return {deviation, std::clamp(input.distance / deviation, -Shape::kDeepest, Shape::kDeepest)};
}

/// Calls put(number) for each of the Shape::kCount; `unit`: mm that log-scales are measured in.
template <typename Put>
void encode_shape(const AdjustmentInput& input, double unit, const Put& put) {
  const Shape shape = shape_of(input);
  put(shape.depth);
  put(std::exp(-0.5 * shape.depth * shape.depth));
  for (int a = 0; a < 3; ++a) {
    put(static_cast<double>(input.along[a]));
    put(input.log_scale[a] - std::log(unit));
  }
}

/// Inputs before padding: x, y, z, distance, sin and cos of each at every octave, then the shape.
size_t input_count(const AdjustmentOptions& options) {
  return 4 + 6 * static_cast<size_t>(options.position_octaves) +
         2 * static_cast<size_t>(options.plane_octaves) + (options.shape ? Shape::kCount : 0);
}

/// mm that an output of 1 moves a mean by.
double mean_unit_of(const AdjustmentOptions& options, double radius, const AdjustmentInput& input) {
  return options.shape ? shape_of(input).deviation : kMeanUnit * radius;
}

std::vector<size_t> layer_sizes(const AdjustmentOptions& options) {
  std::vector<size_t> sizes(static_cast<size_t>(options.hidden_layers) + 2,
                            static_cast<size_t>(options.width));
  sizes.front() = input_count(options);
  sizes.back() = kOutputs;
  return sizes;
}

/// Writes value, then sin and cos of 2ᵒ·π·value, o < octaves, by doubling; returns what follows.
float* encode_number(float value, int octaves, float* out) {
  float s = std::sin(std::numbers::pi_v<float> * value);
  float c = std::cos(std::numbers::pi_v<float> * value);
  *out++ = value;
  for (int o = 0; o < octaves; ++o) {
    *out++ = s;
    *out++ = c;
    const float twice = 2 * s * c;
    c = c * c - s * s;
    s = twice;
  }
  return out;
}

float share_in(float window, float distance) {
  if (window <= 0) {
    return 1;
  }
  const float u = distance / window;
  const float rest = std::max(0.0f, 1 - u * u);
  return rest * rest;
}

}  // namespace

/// Activations of one block of points, [points, neurons] of each layer.
struct Adjustment::Scratch {
  std::vector<std::vector<float>> values;  // inputs, hidden layers, outputs
  std::vector<float> transposed;           // all weights, [in, out]
  std::vector<float> gradient, next;       // ∂L/∂values, of one layer and of the one before
};

Adjustment::Adjustment(const AdjustmentOptions& options, const Sphere& sphere, float extent,
                       std::uint64_t seed)
    : options_(options), sphere_(sphere), extent_(extent) {
  const std::vector<size_t> sizes = layer_sizes(options);
  size_t total = 0;
  for (size_t l = 0; l + 1 < sizes.size(); ++l) {
    layers_.push_back({padded(sizes[l]), padded(sizes[l + 1]), total});
    total += layers_.back().in * layers_.back().out + layers_.back().out;
  }
  weights_.assign(total, 0.0f);
  Rng rng(seed, 0);
  for (size_t l = 0; l + 1 < layers_.size(); ++l) {  // the last stays 0
    // He et al. 2015: keeps the variance through rectifiers.
    const float deviation = std::sqrt(2.0f / static_cast<float>(sizes[l]));
    for (size_t o = 0; o < sizes[l + 1]; ++o) {
      for (size_t i = 0; i < sizes[l]; ++i) {
        weights_[layers_[l].begin + o * layers_[l].in + i] = deviation * rng.normal();
      }
    }
  }
}

float Adjustment::share(float distance) const {
  return share_in(options_.window * extent_, distance);
}

void Adjustment::encode(const AdjustmentInput& input, float* out) const {
  const Vec3 unit = (input.center - sphere_.center) / sphere_.radius;
  float* at = out;
  for (int a = 0; a < 3; ++a) {
    at = encode_number(unit[a], options_.position_octaves, at);
  }
  at = encode_number(input.distance / sphere_.radius, options_.plane_octaves, at);
  if (options_.shape) {
    encode_shape(input, kMeanUnit * sphere_.radius,
                 [&](double number) { *at++ = static_cast<float>(number); });
  }
  std::fill(at, out + layers_.front().in, 0.0f);
}

std::vector<float> Adjustment::transposed_weights() const {
  std::vector<float> result(weights_.size());
  for (const Layer& layer : layers_) {
    for (size_t o = 0; o < layer.out; ++o) {
      for (size_t i = 0; i < layer.in; ++i) {
        result[layer.begin + i * layer.out + o] = weights_[layer.begin + o * layer.in + i];
      }
    }
  }
  return result;
}

float Adjustment::mean_unit(const AdjustmentInput& input) const {
  return static_cast<float>(mean_unit_of(options_, sphere_.radius, input));
}

void Adjustment::run(Scratch& scratch, std::span<const AdjustmentInput> inputs) const {
  const size_t points = inputs.size();
  scratch.values.resize(layers_.size() + 1);
  scratch.values[0].resize(kPoints * layers_.front().in);
  for (size_t p = 0; p < points; ++p) {
    encode(inputs[p], &scratch.values[0][p * layers_.front().in]);
  }
  for (size_t l = 0; l < layers_.size(); ++l) {
    const Layer& layer = layers_[l];
    std::vector<float>& out = scratch.values[l + 1];
    out.resize(kPoints * layer.out);
    multiply({scratch.values[l].data(), layer.in, 1}, &scratch.transposed[layer.begin], points,
             layer.in, layer.out, false, out.data());
    const float* bias = &weights_[layer.begin + layer.in * layer.out];
    const bool rectified = l + 1 < layers_.size();
    for (size_t p = 0; p < points; ++p) {
      float* row = &out[p * layer.out];
      for (size_t o = 0; o < layer.out; ++o) {
        const float value = row[o] + bias[o];
        row[o] = rectified ? std::max(0.0f, value) : value;
      }
    }
  }
}

void Adjustment::forward(std::span<const AdjustmentInput> inputs, std::span<Adjusted> added) const {
  const std::vector<float> transposed = transposed_weights();
  parallel_for(inputs.size(), kAdjustmentGrain, [&](size_t begin, size_t end) {
    Scratch scratch;
    scratch.transposed = transposed;
    for (size_t block = begin; block < end; block += kPoints) {
      const size_t points = std::min(kPoints, end - block);
      run(scratch, inputs.subspan(block, points));
      for (size_t p = 0; p < points; ++p) {
        const float* row = &scratch.values.back()[p * layers_.back().out];
        const AdjustmentInput& input = inputs[block + p];
        const float part = share(input.distance);
        const float unit = mean_unit(input);
        Adjusted& to = added[block + p];
        for (int a = 0; a < 3; ++a) {
          to.mean[a] = part * unit * row[a];
          to.log_scale[a] = part * row[3 + a];
        }
        for (int a = 0; a < 4; ++a) {
          to.rotation[a] = part * row[6 + a];
        }
      }
    }
  });
}

/// ∂L/∂outputs of one block, [points, neurons].
void Adjustment::start_backward(Scratch& scratch, std::span<const AdjustmentInput> inputs,
                                std::span<const Adjusted> gradient) const {
  const size_t width = layers_.back().out;
  scratch.gradient.assign(kPoints * width, 0.0f);
  for (size_t p = 0; p < inputs.size(); ++p) {
    float* row = &scratch.gradient[p * width];
    const float part = share(inputs[p].distance);
    const float unit = mean_unit(inputs[p]);
    for (int a = 0; a < 3; ++a) {
      row[a] = part * unit * gradient[p].mean[a];
      row[3 + a] = part * gradient[p].log_scale[a];
    }
    for (int a = 0; a < 4; ++a) {
      row[6 + a] = part * gradient[p].rotation[a];
    }
  }
}

/// From ∂L/∂(outputs of layer `l`) to ∂L/∂(its weights), added to `sum`, and ∂L/∂(its inputs).
void Adjustment::backward_layer(Scratch& scratch, size_t l, size_t points,
                                std::vector<float>& sum) const {
  const Layer& layer = layers_[l];
  multiply({scratch.gradient.data(), 1, layer.out}, scratch.values[l].data(), layer.out, points,
           layer.in, true, &sum[layer.begin]);
  float* bias = &sum[layer.begin + layer.in * layer.out];
  for (size_t p = 0; p < points; ++p) {
    for (size_t o = 0; o < layer.out; ++o) {
      bias[o] += scratch.gradient[p * layer.out + o];
    }
  }
  if (l == 0) {
    return;
  }
  scratch.next.resize(kPoints * layer.in);
  multiply({scratch.gradient.data(), layer.out, 1}, &weights_[layer.begin], points, layer.out,
           layer.in, false, scratch.next.data());
  for (size_t i = 0; i < points * layer.in; ++i) {
    if (scratch.values[l][i] <= 0) {  // the rectifier
      scratch.next[i] = 0;
    }
  }
  std::swap(scratch.gradient, scratch.next);
}

void Adjustment::backward(std::span<const AdjustmentInput> inputs,
                          std::span<const Adjusted> gradient,
                          std::vector<float>& weight_gradient) const {
  const std::vector<float> transposed = transposed_weights();
  // Summed piece by piece, in order: the same at any number of threads.
  std::vector<std::vector<float>> sums((inputs.size() + kAdjustmentGrain - 1) / kAdjustmentGrain);
  parallel_for(inputs.size(), kAdjustmentGrain, [&](size_t begin, size_t end) {
    Scratch scratch;
    scratch.transposed = transposed;
    std::vector<float>& sum = sums[begin / kAdjustmentGrain];
    sum.assign(weights_.size(), 0.0f);
    for (size_t block = begin; block < end; block += kPoints) {
      const size_t points = std::min(kPoints, end - block);
      run(scratch, inputs.subspan(block, points));
      start_backward(scratch, inputs.subspan(block, points), gradient.subspan(block, points));
      for (size_t l = layers_.size(); l-- > 0;) {
        backward_layer(scratch, l, points, sum);
      }
    }
  });
  weight_gradient.assign(weights_.size(), 0.0f);
  for (const std::vector<float>& sum : sums) {
    for (size_t i = 0; i < sum.size(); ++i) {
      weight_gradient[i] += sum[i];
    }
  }
}

std::vector<double> reference_adjustment(const AdjustmentOptions& options, const Sphere& sphere,
                                         float extent, std::span<const double> weights,
                                         const AdjustmentInput& input) {
  std::vector<double> values;
  const auto encode = [&](double value, int octaves) {
    values.push_back(value);
    for (int o = 0; o < octaves; ++o) {
      values.push_back(std::sin(std::exp2(o) * std::numbers::pi * value));
      values.push_back(std::cos(std::exp2(o) * std::numbers::pi * value));
    }
  };
  for (int a = 0; a < 3; ++a) {
    encode((static_cast<double>(input.center[a]) - sphere.center[a]) / sphere.radius,
           options.position_octaves);
  }
  encode(static_cast<double>(input.distance) / sphere.radius, options.plane_octaves);
  if (options.shape) {
    encode_shape(input, kMeanUnit * sphere.radius,
                 [&](double number) { values.push_back(number); });
  }
  const std::vector<size_t> sizes = layer_sizes(options);
  size_t begin = 0;
  for (size_t l = 0; l + 1 < sizes.size(); ++l) {
    const size_t in = padded(sizes[l]);
    const size_t out = padded(sizes[l + 1]);
    std::vector<double> next(sizes[l + 1]);
    for (size_t o = 0; o < next.size(); ++o) {
      next[o] = weights[begin + in * out + o];
      for (size_t i = 0; i < sizes[l]; ++i) {
        next[o] += weights[begin + o * in + i] * values[i];
      }
      if (l + 2 < sizes.size()) {
        next[o] = std::max(0.0, next[o]);
      }
    }
    values = std::move(next);
    begin += in * out + out;
  }
  const double part = share_in(options.window * extent, input.distance);
  const double unit = mean_unit_of(options, sphere.radius, input);
  for (size_t o = 0; o < values.size(); ++o) {
    values[o] *= o < 3 ? part * unit : part;
  }
  return values;
}

}  // namespace clipgs
