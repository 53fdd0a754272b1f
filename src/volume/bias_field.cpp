#include "volume/bias_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "volume/histogram.h"
#include "volume/rewrite_values.h"
#include "volume/spline_field.h"

namespace clipgs {
namespace {

constexpr int kMostPlaces = 48;       // along each axis of the grid that the field is sought on
constexpr int kLevels[] = {1, 2, 4};  // pieces of the spline along each axis
constexpr int kMostSteps = 30;        // on each level
constexpr double kConverged = 1e-3;   // standard deviation of the change, of the logarithm
constexpr double kWidth = 0.15;       // FWHM, of the logarithm, of what the field blurs (N3)
constexpr double kNoise = 0.01;       // of Wiener's filter (N3)
constexpr int kBins = 200;            // of the histogram (N4)
constexpr int kPadded = 512;          // … with as much empty around it as its blur needs

using Spectrum = std::vector<std::complex<double>>;

/// The shrunken volume: logarithms of the means of blocks.
struct Coarse {
  IVec3 dims{0};
  std::vector<float> logs;
  std::vector<std::uint8_t> inside;  ///< blocks of which half is foreground
};

Coarse shrink(const Volume& volume, float least) {
  const IVec3 factor = (volume.dims + kMostPlaces - 1) / kMostPlaces;
  Coarse coarse;
  coarse.dims = (volume.dims + factor - 1) / factor;
  const size_t count = static_cast<size_t>(coarse.dims.x) * coarse.dims.y * coarse.dims.z;
  coarse.logs.resize(count);
  coarse.inside.resize(count);
  parallel_for(count, 64, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const IVec3 block(i % coarse.dims.x, i / coarse.dims.x % coarse.dims.y,
                        i / (static_cast<size_t>(coarse.dims.x) * coarse.dims.y));
      const IVec3 low = block * factor;
      const IVec3 high = glm::min(low + factor, volume.dims);
      double sum = 0;
      int foreground = 0;
      for (int z = low.z; z < high.z; ++z) {
        for (int y = low.y; y < high.y; ++y) {
          for (int x = low.x; x < high.x; ++x) {
            const float value = volume.at(x, y, z);
            sum += value > least ? value : 0.0f;
            foreground += value > least ? 1 : 0;
          }
        }
      }
      const IVec3 size = high - low;
      coarse.inside[i] = 2 * foreground >= size.x * size.y * size.z ? 1 : 0;
      coarse.logs[i] = coarse.inside[i] != 0 ? static_cast<float>(std::log(sum / foreground)) : 0;
    }
  });
  return coarse;
}

/// By the definition: there are few numbers. `sign` is −1, or 1 for the inverse without its scale.
Spectrum fourier(const Spectrum& from, int sign) {
  const size_t n = from.size();
  Spectrum turns(n);
  for (size_t i = 0; i < n; ++i) {
    turns[i] = std::polar(
        1.0, sign * 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n));
  }
  Spectrum to(n);
  for (size_t k = 0; k < n; ++k) {
    for (size_t i = 0; i < n; ++i) {
      to[k] += from[i] * turns[k * i % n];
    }
  }
  return to;
}

/// `filter(frequency's transform of a Gaussian)` applied to a histogram.
template <typename Filter>
std::vector<double> filtered(const std::vector<double>& counts, const Spectrum& gaussian,
                             const Filter& filter) {
  Spectrum spectrum = fourier({counts.begin(), counts.end()}, -1);
  for (size_t k = 0; k < spectrum.size(); ++k) {
    spectrum[k] *= filter(gaussian[k]);
  }
  spectrum = fourier(spectrum, 1);
  std::vector<double> result(counts.size());
  for (size_t i = 0; i < result.size(); ++i) {
    result[i] = spectrum[i].real() / static_cast<double>(result.size());
  }
  return result;
}

/// What each value of the histogram is expected to have been before the field blurred it: bins, of
/// bins (Sled et al., equations 8 to 10).
std::vector<double> sharpened(const std::vector<double>& counts, double bin_width) {
  const double sigma = kWidth / bin_width / (2 * std::sqrt(2 * std::numbers::ln2));
  std::vector<double> bell(counts.size());
  double sum = 0;
  for (size_t i = 0; i < bell.size(); ++i) {
    const double x = static_cast<double>(std::min(i, bell.size() - i)) / sigma;
    bell[i] = std::exp(-0.5 * x * x);
    sum += bell[i];
  }
  std::ranges::for_each(bell, [sum](double& b) { b /= sum; });
  const Spectrum gaussian = fourier({bell.begin(), bell.end()}, -1);
  std::vector<double> sharp = filtered(counts, gaussian, [](const std::complex<double>& f) {
    return std::conj(f) / (std::norm(f) + kNoise);
  });
  std::ranges::for_each(sharp, [](double& s) { s = std::max(s, 0.0); });
  std::vector<double> moments(sharp.size());
  for (size_t i = 0; i < moments.size(); ++i) {
    moments[i] = static_cast<double>(i) * sharp[i];
  }
  const auto blur = [](const std::complex<double>& f) { return f; };
  const std::vector<double> above = filtered(moments, gaussian, blur);
  const std::vector<double> below = filtered(sharp, gaussian, blur);
  std::vector<double> expected(sharp.size());
  for (size_t i = 0; i < expected.size(); ++i) {
    expected[i] = below[i] > 1e-9 ? above[i] / below[i] : static_cast<double>(i);
  }
  return expected;
}

/// What sharpening the histogram of `logs` changes of each: the field that is left in them.
std::vector<float> residual(const Coarse& coarse, const std::vector<float>& logs) {
  float low = std::numeric_limits<float>::max();
  float high = std::numeric_limits<float>::lowest();
  for (size_t i = 0; i < logs.size(); ++i) {
    if (coarse.inside[i] != 0) {
      low = std::min(low, logs[i]);
      high = std::max(high, logs[i]);
    }
  }
  const double width = std::max(static_cast<double>(high) - low, 1e-6) / (kBins - 1);
  constexpr int kFirst = (kPadded - kBins) / 2;
  const auto place = [&](float log) { return kFirst + (static_cast<double>(log) - low) / width; };
  std::vector<double> counts(kPadded);
  for (size_t i = 0; i < logs.size(); ++i) {
    if (coarse.inside[i] != 0) {
      const double at = place(logs[i]);
      const auto bin = static_cast<size_t>(at);
      counts[bin] += 1 - (at - static_cast<double>(bin));
      counts[bin + 1] += at - static_cast<double>(bin);
    }
  }
  const std::vector<double> expected = sharpened(counts, width);
  std::vector<float> left(logs.size());
  for (size_t i = 0; i < logs.size(); ++i) {
    if (coarse.inside[i] != 0) {
      const double at = place(logs[i]);
      const auto bin = static_cast<size_t>(at);
      const double t = at - static_cast<double>(bin);
      left[i] = static_cast<float>(width * (at - std::lerp(expected[bin], expected[bin + 1], t)));
    }
  }
  return left;
}

/// The field at the grid's places.
std::vector<float> values_of(const SplineField& field, const IVec3& dims) {
  const auto x = supports(field, dims.x);
  const auto y = supports(field, dims.y);
  const auto z = supports(field, dims.z);
  std::vector<float> values(static_cast<size_t>(dims.x) * dims.y * dims.z);
  for (size_t row = 0; row < y.size() * z.size(); ++row) {
    field.evaluate_row(x, y[row % y.size()], z[row / y.size()], &values[row * x.size()]);
  }
  return values;
}

struct Moments {
  double mean = 0;
  double deviation = 0;
};

Moments moments_inside(const Coarse& coarse, const std::vector<float>& values) {
  double count = 0;
  double sum = 0;
  double squares = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    if (coarse.inside[i] != 0) {
      count += 1;
      sum += values[i];
      squares += static_cast<double>(values[i]) * values[i];
    }
  }
  const double mean = sum / std::max(count, 1.0);
  return {mean, std::sqrt(std::max(squares / std::max(count, 1.0) - mean * mean, 0.0))};
}

/// Adds a spline of each level to the field, as long as it changes.
std::vector<SplineField> find_field(const Coarse& coarse) {
  std::vector<SplineField> field;
  std::vector<float> logs = coarse.logs;
  for (const int elements : kLevels) {
    field.emplace_back(elements);
    for (int step = 0; step < kMostSteps; ++step) {
      const SplineField change =
          approximate(coarse.dims, residual(coarse, logs), coarse.inside, elements);
      const std::vector<float> values = values_of(change, coarse.dims);
      field.back().add(change);
      std::ranges::transform(logs, values, logs.begin(), std::minus());
      if (moments_inside(coarse, values).deviation < kConverged) {
        break;
      }
    }
  }
  return field;
}

}  // namespace

BiasField correct_bias(Volume& volume, const std::string& where) {
  const Histogram values = histogram(volume);
  const float least = least_signal(values);
  if (!volume.rgb.empty() || least <= 0) {
    throw Error("{}: --bias needs a signal above zero, as MR has", where);
  }
  const Coarse coarse = shrink(volume, least);
  const std::vector<SplineField> field = find_field(coarse);
  std::vector<float> logs(coarse.logs.size());
  for (const SplineField& part : field) {
    std::ranges::transform(logs, values_of(part, coarse.dims), logs.begin(), std::plus());
  }
  const auto mean = static_cast<float>(moments_inside(coarse, logs).mean);
  float low = std::numeric_limits<float>::max();
  float high = std::numeric_limits<float>::lowest();
  for (size_t i = 0; i < logs.size(); ++i) {
    if (coarse.inside[i] != 0) {
      low = std::min(low, logs[i] - mean);
      high = std::max(high, logs[i] - mean);
    }
  }

  std::vector<std::array<std::vector<SplineField::Support>, 3>> places;
  places.reserve(field.size());
  for (const SplineField& part : field) {
    places.push_back({supports(part, volume.dims.x), supports(part, volume.dims.y),
                      supports(part, volume.dims.z)});
  }
  const float most = std::max(std::abs(values.min), std::abs(values.max)) * std::exp(-low);
  rewrite_values(volume, value_step(values.min < 0 ? 2 * most : most), [&](int z, float* slice) {
    const auto width = static_cast<size_t>(volume.dims.x);
    std::vector<float> row(width);
    std::vector<float> sum(width);
    for (int y = 0; y < volume.dims.y; ++y) {
      std::ranges::fill(sum, 0.0f);
      for (size_t part = 0; part < field.size(); ++part) {
        const auto& [along_x, along_y, along_z] = places[part];
        field[part].evaluate_row(along_x, along_y[y], along_z[z], row.data());
        std::ranges::transform(sum, row, sum.begin(), std::plus());
      }
      const size_t from = volume.offset(0, y, z);
      for (size_t x = 0; x < width; ++x) {
        // Beyond the foreground, where nothing is known of it, the field is that of its border.
        slice[y * width + x] =
            volume.values[from + x] * std::exp(-std::clamp(sum[x] - mean, low, high));
      }
    }
  });
  return {std::exp(low), std::exp(high)};
}

}  // namespace clipgs
