#include "section/fit_reflectance.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/parallel.h"
#include "core/progress.h"
#include "section/face_light.h"
#include "section/face_rays.h"

namespace clipgs {
namespace {

// Reflectances are the preset's albedo times a gain, linear between knots over the codes: once for
// matter at the face, once for matter beneath it.
constexpr int kKnots = 18;
constexpr int kUnknowns = 2 * kKnots;
constexpr int kTaps = 24;
constexpr size_t kMaxFrames = 160;
constexpr int kStride = 2;  // pixels: neighbours say much the same
constexpr float kOpaque = 0.99f;
// Pixels count less the more they are off, as an error with Cauchy's distribution of this scale, of
// the display's range, has it: translucent rims and light from beside are not the tables' to learn.
constexpr double kTolerance = 0.1;
constexpr int kPasses = 3;  // the first without weights
constexpr double kCodesPerKnot = static_cast<double>(ValueCurve::kCodes - 1) / (kKnots - 1);

using Row = Eigen::Matrix<double, kUnknowns, 1>;
using Matrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;

/// Where between knots a code lies.
struct Place {
  int knot;
  double toward_next;
};

Place place_of(double code) {
  const double at = code / kCodesPerKnot;
  const int knot = std::clamp(static_cast<int>(at), 0, kKnots - 2);
  return {knot, at - knot};
}

using Gains = std::array<Row, 3>;

/// The least squares of one colour channel: Σ weight·(row·gains − target)².
struct Normal {
  Matrix matrix = Matrix::Zero();
  Row right = Row::Zero();
  double targets = 0;

  void add(const Row& row, double target, double weight) {
    matrix.noalias() += weight * row * row.transpose();
    right += weight * target * row;
    targets += weight * target * target;
  }
  void add(const Normal& other) {
    matrix += other.matrix;
    right += other.right;
    targets += other.targets;
  }
  double error(const Row& gains) const { return gains.dot(matrix * gains - 2 * right) + targets; }
};

/// What one pixel says: for each channel, light = row·gains + gloss.
struct Pixel {
  std::array<Row, 3> rows = {Row::Zero(), Row::Zero(), Row::Zero()};
  Vec3 gloss{0};
  float alpha = 0;
};

Pixel pixel_of(const Section& section, const FaceRays& rays, int x, int y) {
  Pixel pixel;
  constexpr int kRays = 4;
  constexpr float share = 1.0f / kRays;
  rays.for_rays(x, y, kRays, [&](const FaceRay& ray) {
    const auto add = [&](float weight, const Vec3& sampled, float code,
                         const FaceMaterial& material, bool surface) {
      Vec3 light =
          (share * weight) * (surface ? material.surface : material.interior) * ray.face->light;
      if (section.channels == 3) {
        light *= photo_albedo(sampled);
      }
      const Place place = place_of(code);
      const int first = (surface ? 0 : kKnots) + place.knot;
      for (int c = 0; c < 3; ++c) {
        pixel.rows[static_cast<size_t>(c)][first] += light[c] * (1 - place.toward_next);
        pixel.rows[static_cast<size_t>(c)][first + 1] += light[c] * place.toward_next;
      }
      if (surface && material.specular > 0) {
        pixel.gloss +=
            (share * weight * material.specular) *
            face_gloss(section.rig, ray.face->outward, -ray.direction, material.roughness);
      }
    };
    pixel.alpha += share * rays.march(ray, add).alpha;
  });
  return pixel;
}

/// Calls use(pixel, truth) for every pixel of the frame where the face is opaque; truth is linear,
/// before exposure.
template <typename Use>
void for_face_pixels(const Section& section, const Dataset& dataset, const Frame& frame,
                     const Use& use) {
  const FaceRays rays(section, frame.camera, frame.plane, kTaps);
  if (!rays.any()) {
    return;
  }
  const Image truth = dataset.load(frame);
  for (int y = 0; y < truth.height; y += kStride) {
    for (int x = 0; x < truth.width; x += kStride) {
      const float* rgba = truth.at(x, y);
      if (truth.channels == 4 && rgba[3] < kOpaque) {
        continue;
      }
      const Pixel pixel = pixel_of(section, rays, x, y);
      if (pixel.alpha > kOpaque) {
        use(pixel, Vec3(linear_from_display(rgba[0], section.tone),
                        linear_from_display(rgba[1], section.tone),
                        linear_from_display(rgba[2], section.tone)) /
                       section.exposure);
      }
    }
  }
}

/// Training frames that show a face, evenly chosen.
std::vector<const Frame*> frames_with_faces(const Section& section, const Dataset& dataset) {
  const std::vector<Plane> ends = section.ends();
  std::vector<const Frame*> all;
  for (const Frame* frame : dataset.split(Split::kTrain)) {
    const auto seen = [&](const Plane& face) {
      return face.signed_distance(frame->camera.position) < 0;
    };
    if ((frame->plane && seen(*frame->plane)) || std::ranges::any_of(ends, seen)) {
      all.push_back(frame);
    }
  }
  const size_t count = std::min(all.size(), kMaxFrames);
  std::vector<const Frame*> some(count);
  for (size_t i = 0; i < count; ++i) {
    some[i] = all[i * all.size() / count];
  }
  return some;
}

/// ∂(display sRGB)/∂(linear light before exposure).
float display_slope(float linear, const Section& section) {
  constexpr float kStep = 1e-3f;
  const float at = std::clamp(section.exposure * linear, kStep, untoned(1, section.tone) - kStep);
  const float change =
      display_from_linear(at + kStep, section.tone) - display_from_linear(at - kStep, section.tone);
  return section.exposure * change / (2 * kStep);
}

/// Gains near 1 where pixels say little, and alike at neighbouring knots.
Row solve(Normal normal, double pixels) {
  const double trust = 1e-5 * pixels;
  const double smooth = 1e-4 * pixels;
  for (int i = 0; i < kUnknowns; ++i) {
    normal.matrix(i, i) += trust;
    normal.right[i] += trust;
    if ((i + 1) % kKnots != 0) {
      normal.matrix(i, i) += smooth;
      normal.matrix(i + 1, i + 1) += smooth;
      normal.matrix(i, i + 1) -= smooth;
      normal.matrix(i + 1, i) -= smooth;
    }
  }
  return normal.matrix.ldlt().solve(normal.right);
}

/// Multiplies the tables of one colour channel by what was found.
void apply_gains(const Row& gains, glm::length_t channel, Section& section) {
  constexpr double kMostGain = 4;
  for (size_t code = 0; code < section.materials.size(); ++code) {
    const Place place = place_of(static_cast<double>(code));
    const auto gain = [&](int first) {
      const int knot = first + place.knot;
      const double between = std::lerp(gains[knot], gains[knot + 1], place.toward_next);
      return static_cast<float>(std::clamp(between, 0.0, kMostGain));
    };
    FaceMaterial& material = section.materials[code];
    material.surface[channel] *= gain(0);
    material.boundary[channel] *= gain(0);
    material.interior[channel] *= gain(kKnots);
  }
}

double psnr(double squared_error, double values) {
  return values > 0 ? -10 * std::log10(std::max(squared_error / values, 1e-12)) : 0;
}

/// The least squares of all channels, and the pixels that they weigh as much as.
struct Sums {
  std::array<Normal, 3> normals;
  double weight = 0;

  void add(const Section& section, const Pixel& pixel, const Vec3& truth, const Gains& gains,
           double tolerance) {
    Vec3 slopes;
    double error = 0;
    for (int c = 0; c < 3; ++c) {
      const auto k = static_cast<size_t>(c);
      slopes[c] = display_slope(truth[c], section);
      const double off = slopes[c] * (pixel.rows[k].dot(gains[k]) + pixel.gloss[c] - truth[c]);
      error += off * off / 3;
    }
    const double share = 1 / (1 + error / (tolerance * tolerance));
    for (int c = 0; c < 3; ++c) {
      const auto k = static_cast<size_t>(c);
      normals[k].add(pixel.rows[k], truth[c] - pixel.gloss[c], share * slopes[c] * slopes[c]);
    }
    weight += share;
  }
  void add(const Sums& other) {
    for (size_t c = 0; c < 3; ++c) {
      normals[c].add(other.normals[c]);
    }
    weight += other.weight;
  }
};

/// What the pixels of all frames say, weighed by how far `gains` are from them.
Sums sum_up(const Section& section, const Dataset& dataset, const std::vector<const Frame*>& frames,
            const Gains& gains, double tolerance, Progress& progress, size_t done) {
  // A sum for every frame, so that the order in which threads finish changes nothing.
  std::vector<Sums> sums(frames.size());
  constexpr size_t kBatch = 16;
  for (size_t first = 0; first < frames.size(); first += kBatch) {
    const size_t count = std::min(kBatch, frames.size() - first);
    parallel_for(count, 1, [&](size_t i, size_t) {
      for_face_pixels(section, dataset, *frames[first + i],
                      [&](const Pixel& pixel, const Vec3& truth) {
                        sums[first + i].add(section, pixel, truth, gains, tolerance);
                      });
    });
    progress.update(done + first + count);
  }
  Sums all;
  for (const Sums& sum : sums) {
    all.add(sum);
  }
  return all;
}

}  // namespace

ReflectanceFit fit_reflectance(Section& section, const Dataset& dataset) {
  const std::vector<const Frame*> frames = frames_with_faces(section, dataset);
  ReflectanceFit fit;
  Gains gains = {Row::Ones(), Row::Ones(), Row::Ones()};
  Progress progress("face light", kPasses * frames.size());
  for (int pass = 0; pass < kPasses; ++pass) {
    const double tolerance = pass == 0 ? std::numeric_limits<double>::infinity() : kTolerance;
    const Sums sums =
        sum_up(section, dataset, frames, gains, tolerance, progress, pass * frames.size());
    if (sums.weight == 0) {
      return fit;
    }
    double before = 0;
    double after = 0;
    for (size_t c = 0; c < 3; ++c) {
      gains[c] = solve(sums.normals[c], sums.weight);
      before += sums.normals[c].error(Row::Ones());
      after += sums.normals[c].error(gains[c]);
    }
    fit = {psnr(before, 3 * sums.weight), psnr(after, 3 * sums.weight),
           static_cast<size_t>(sums.weight)};
  }
  for (size_t c = 0; c < 3; ++c) {
    apply_gains(gains[c], static_cast<glm::length_t>(c), section);
  }
  return fit;
}

}  // namespace clipgs
