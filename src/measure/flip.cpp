#include "measure/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "core/geometry.h"
#include "core/parallel.h"
#include "measure/metrics.h"

namespace clipgs {
namespace {

using glm::dmat3;
using glm::dvec3;
using std::numbers::pi;

// Constants of the paper.
constexpr double kColorExponent = 0.7;    // q_c
constexpr double kKnee = 0.4;             // p_c, of the largest difference of colour …
constexpr double kKneeValue = 0.95;       // p_t … which becomes this
constexpr double kFeatureWidth = 0.082;   // w, degrees
constexpr double kFeatureExponent = 0.5;  // q_f
constexpr double kLargestSpread = 0.04;   // of the filters below

/// a·√(π/b)·exp(−π²r²/b), r in degrees: a term of the contrast sensitivity, in space.
struct Term {
  double a, b;
};
constexpr std::array<std::array<Term, 2>, 3> kSensitivity = {
    {{{{1, 0.0047}, {0, 1e-5}}}, {{{1, 0.0053}, {0, 1e-5}}}, {{{34.1, 0.04}, {13.5, 0.025}}}}};

/// One value a pixel.
struct Plane2 {
  int width = 0;
  int height = 0;
  std::vector<double> values;

  Plane2(int w, int h) : width(w), height(h), values(static_cast<size_t>(w) * h) {}
  double& at(int x, int y) { return values[static_cast<size_t>(y) * width + x]; }
  double at(int x, int y) const { return values[static_cast<size_t>(y) * width + x]; }
};

template <typename Visit>
void for_each_row(int height, const Visit& visit) {
  parallel_for(static_cast<size_t>(height), 8, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y) {
      visit(static_cast<int>(y));
    }
  });
}

/// Σ along·across over the neighbourhood of every pixel; beyond the border its pixels go on.
/// Kernels have an odd length.
Plane2 filtered(const Plane2& in, const std::vector<double>& along_x,
                const std::vector<double>& along_y) {
  Plane2 rows(in.width, in.height);
  const int rx = static_cast<int>(along_x.size() / 2);
  for_each_row(in.height, [&](int y) {
    for (int x = 0; x < in.width; ++x) {
      double sum = 0;
      for (size_t k = 0; k < along_x.size(); ++k) {
        const int from = x + static_cast<int>(k) - rx;
        sum += along_x[k] * in.at(std::clamp(from, 0, in.width - 1), y);
      }
      rows.at(x, y) = sum;
    }
  });
  Plane2 out(in.width, in.height);
  const int ry = static_cast<int>(along_y.size() / 2);
  for_each_row(in.height, [&](int y) {
    for (size_t k = 0; k < along_y.size(); ++k) {
      const int from = std::clamp(y + static_cast<int>(k) - ry, 0, in.height - 1);
      for (int x = 0; x < in.width; ++x) {
        out.at(x, y) += along_y[k] * rows.at(x, from);
      }
    }
  });
  return out;
}

/// exp(−x²·scale) at −radius … radius, x in units of `step`.
std::vector<double> bell(int radius, double step, double scale) {
  std::vector<double> kernel;
  for (int i = -radius; i <= radius; ++i) {
    kernel.push_back(std::exp(-scale * i * i * step * step));
  }
  return kernel;
}

double sum_of(const std::vector<double>& kernel) {
  return std::accumulate(kernel.begin(), kernel.end(), 0.0);
}

/// Blurred by what an eye cannot tell apart in this channel.
Plane2 as_seen(const Plane2& in, const std::array<Term, 2>& terms, double pixels_per_degree) {
  const int radius = static_cast<int>(
      std::ceil(3 * std::sqrt(kLargestSpread / (2 * pi * pi)) * pixels_per_degree));
  Plane2 out(in.width, in.height);
  double norm = 0;
  for (const Term& term : terms) {
    if (term.a > 0) {
      const std::vector<double> kernel = bell(radius, 1 / pixels_per_degree, pi * pi / term.b);
      const double weight = term.a * std::sqrt(pi / term.b);
      const double sum = sum_of(kernel);
      norm += weight * sum * sum;
      const Plane2 part = filtered(in, kernel, kernel);
      for (size_t i = 0; i < out.values.size(); ++i) {
        out.values[i] += weight * part.values[i];
      }
    }
  }
  for (double& value : out.values) {
    value /= norm;
  }
  return out;
}

// Columns: XYZ of the primaries of linear sRGB (IEC 61966-2-1), white D65.
const dmat3 kXyzFromRgb(0.4123908, 0.2126390, 0.0193308, 0.3575843, 0.7151687, 0.1191948, 0.1804808,
                        0.0721923, 0.9505322);
const dvec3 kWhite = kXyzFromRgb * dvec3(1);

/// Y, Cx, Cz: like CIELAB, but linear (Flohr et al. 1993).
dvec3 opponent_of(const dvec3& rgb) {
  const dvec3 xyz = kXyzFromRgb * rgb / kWhite;
  return {116 * xyz.y - 16, 500 * (xyz.x - xyz.y), 200 * (xyz.y - xyz.z)};
}

dvec3 rgb_of_opponent(const dvec3& opponent) {
  const double y = (opponent.x + 16) / 116;
  const dvec3 xyz(y + opponent.y / 500, y, y - opponent.z / 200);
  return glm::inverse(kXyzFromRgb) * (xyz * kWhite);
}

/// CIELAB whose colours fade with the lightness, as they do to an eye (Hunt 1952).
dvec3 hunt_lab_of(const dvec3& rgb) {
  const dvec3 xyz = kXyzFromRgb * rgb / kWhite;
  const auto f = [](double t) {
    constexpr double kDelta = 6.0 / 29;
    return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29;
  };
  const double lightness = 116 * f(xyz.y) - 16;
  return {lightness, 0.01 * lightness * 500 * (f(xyz.x) - f(xyz.y)),
          0.01 * lightness * 200 * (f(xyz.y) - f(xyz.z))};
}

/// For large differences (Abasi, Tehran, Fairchild 2020).
double hyab(const dvec3& a, const dvec3& b) {
  return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

double color_difference(const dvec3& a, const dvec3& b) {
  static const double most =
      std::pow(hyab(hunt_lab_of({0, 1, 0}), hunt_lab_of({0, 0, 1})), kColorExponent);
  const double difference = std::pow(hyab(a, b), kColorExponent);
  const double knee = kKnee * most;
  return difference < knee ? kKneeValue / knee * difference
                           : kKneeValue + (difference - knee) / (most - knee) * (1 - kKneeValue);
}

/// Weights that are positive sum up to 1, those that are negative to −1.
std::vector<double> balanced(std::vector<double> kernel) {
  double positive = 0;
  double negative = 0;
  for (const double w : kernel) {
    (w > 0 ? positive : negative) += std::abs(w);
  }
  for (double& w : kernel) {
    w /= w > 0 ? positive : negative > 0 ? negative : 1;
  }
  return kernel;
}

/// How much of an edge, and of a point, each pixel is.
struct Features {
  Plane2 edges;
  Plane2 points;
};

Features features_of(const Plane2& lightness, double pixels_per_degree) {
  const double deviation = 0.5 * kFeatureWidth * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3 * deviation));
  std::vector<double> smooth = bell(radius, 1, 0.5 / (deviation * deviation));
  std::vector<double> first = smooth;
  std::vector<double> second = smooth;
  for (size_t k = 0; k < smooth.size(); ++k) {
    const double x = (static_cast<double>(k) - radius) / deviation;
    first[k] *= -x;
    second[k] *= x * x - 1;
  }
  first = balanced(std::move(first));
  second = balanced(std::move(second));
  const double sum = sum_of(smooth);
  for (double& w : smooth) {
    w /= sum;
  }
  const auto magnitude = [&](const std::vector<double>& kernel) {
    Plane2 across = filtered(lightness, kernel, smooth);
    const Plane2 down = filtered(lightness, smooth, kernel);
    for (size_t i = 0; i < across.values.size(); ++i) {
      across.values[i] = std::hypot(across.values[i], down.values[i]);
    }
    return across;
  };
  return {magnitude(first), magnitude(second)};
}

/// A picture, as far as an eye sees it.
struct Seen {
  std::vector<dvec3> colors;
  Features features;
};

Seen see(const Image& image, double pixels_per_degree) {
  const Image rgb = composite(image, 0, 0, 0);
  std::array<Plane2, 3> channels = {Plane2(rgb.width, rgb.height), Plane2(rgb.width, rgb.height),
                                    Plane2(rgb.width, rgb.height)};
  Plane2 lightness(rgb.width, rgb.height);
  for (size_t i = 0; i < rgb.pixels(); ++i) {
    const float* in = &rgb.data[3 * i];
    const dvec3 opponent =
        opponent_of({linear_from_srgb(in[0]), linear_from_srgb(in[1]), linear_from_srgb(in[2])});
    for (int c = 0; c < 3; ++c) {
      channels[static_cast<size_t>(c)].values[i] = opponent[c];
    }
    lightness.values[i] = (opponent.x + 16) / 116;
  }
  for (size_t c = 0; c < 3; ++c) {
    channels[c] = as_seen(channels[c], kSensitivity[c], pixels_per_degree);
  }
  Seen seen{std::vector<dvec3>(rgb.pixels()), features_of(lightness, pixels_per_degree)};
  parallel_for(rgb.pixels(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const dvec3 color =
          rgb_of_opponent({channels[0].values[i], channels[1].values[i], channels[2].values[i]});
      seen.colors[i] = hunt_lab_of(glm::clamp(color, dvec3(0), dvec3(1)));
    }
  });
  return seen;
}

}  // namespace

Image flip_map(const Image& truth, const Image& picture, float pixels_per_degree) {
  require_same_size(truth, picture);
  const Seen a = see(truth, pixels_per_degree);
  const Seen b = see(picture, pixels_per_degree);
  Image map(truth.width, truth.height, 1);
  parallel_for(map.pixels(), 4096, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const double edges = a.features.edges.values[i] - b.features.edges.values[i];
      const double points = a.features.points.values[i] - b.features.points.values[i];
      const double feature = std::max(std::abs(edges), std::abs(points)) / std::numbers::sqrt2;
      const double color = color_difference(a.colors[i], b.colors[i]);
      map.data[i] = static_cast<float>(std::pow(color, 1 - std::pow(feature, kFeatureExponent)));
    }
  });
  return map;
}

}  // namespace clipgs
