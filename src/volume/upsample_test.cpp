#include "volume/upsample.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "volume/test_bodies.h"

namespace clipgs {
namespace {

constexpr float kSurface = -250;  // HU, where presets have skin begin

Vec3 outward(const SolidBody& body, const Vec3& at) {
  constexpr float kStep = 0.01f;
  Vec3 gradient;
  for (int k = 0; k < 3; ++k) {
    Vec3 step(0);
    step[k] = kStep;
    gradient[k] = body(at + step) - body(at - step);
  }
  return glm::normalize(gradient);
}

/// As the path tracer takes it: central differences over a voxel to either side.
Vec3 traced_normal(const Volume& volume, const Vec3& at) {
  Vec3 gradient;
  for (int k = 0; k < 3; ++k) {
    Vec3 step(0);
    step[k] = volume.spacing[k];
    gradient[k] = (volume.sample(at + step) - volume.sample(at - step)) / volume.spacing[k];
  }
  return -glm::normalize(gradient);
}

struct SurfaceErrors {
  double normals = 0;  ///< rms, degrees
  double place = 0;    ///< standard deviation of how far it lies off, mm
};

/// Of the surface of `volume` against the body that it is a scan of.
SurfaceErrors surface_errors(const Volume& volume, const SolidBody& body, float half_side) {
  constexpr int kPoints = 1000;
  Rng rng(5, 0);
  double squares = 0;
  std::vector<double> places;
  while (places.size() < kPoints) {
    Vec3 at = half_side * (2.0f * Vec3(rng.uniform(), rng.uniform(), rng.uniform()) - 1.0f);
    for (int i = 0; i < 10; ++i) {
      at -= body(at) * outward(body, at);
    }
    const Vec3 out = outward(body, at);
    if (std::abs(body(at)) > 0.01f ||
        std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}) > half_side) {
      continue;
    }
    float t = -4;
    while (t < 4 && volume.sample(at + t * out) > kSurface) {
      t += 0.02f;
    }
    const Vec3 found = at + t * out;
    const float cosine = glm::dot(traced_normal(volume, found), outward(body, found));
    squares += std::pow(glm::degrees(std::acos(std::min(cosine, 1.0f))), 2);
    places.push_back(t);
  }
  double mean = 0;
  for (const double place : places) {
    mean += place / kPoints;
  }
  double variance = 0;
  for (const double place : places) {
    variance += (place - mean) * (place - mean) / kPoints;
  }
  return {std::sqrt(squares / kPoints), std::sqrt(variance)};
}

struct Body {
  const char* name;
  SolidBody distance;
  float half_side;  // mm, of the part that is looked at
};

const std::vector<Body>& bodies() {
  static const std::vector<Body> kBodies = {{"ball", ball(48.3f), 58},
                                            {"torus", tilted_torus(34.2f, 15.4f), 58},
                                            {"face", face_like(), 44}};
  return kBodies;
}

/// Skin begins at kSurface; what is inside is solid.
TransferFunction skin() {
  return TransferFunction({{-300, {Vec3(1), 0}}, {-200, {Vec3(1), 2.5f}}});
}

Volume upsampled(const Volume& scanned) { return upsample(scanned, skin()); }

struct Scanner {
  const char* name;
  Vec3 spacing;
  float step;  // HU between stored values
};

class UpsampleSurfaces : public testing::TestWithParam<Scanner> {};

// The figures are in docs/tried.md.
TEST_P(UpsampleSurfaces, AreTwiceAsTrueToTheBody) {
  const Scanner& scanner = GetParam();
  for (const Body& body : bodies()) {
    if (scanner.spacing == Vec3(1) && body.half_side > 50) {
      continue;  // minutes, under a sanitizer
    }
    TestScan how;
    how.spacing = scanner.spacing;
    how.step = scanner.step;
    how.noise = 15;
    how.half_side = body.half_side + 8;
    const Volume scanned = scan(body.distance, how);
    const SurfaceErrors before = surface_errors(scanned, body.distance, body.half_side);
    const SurfaceErrors after = surface_errors(upsampled(scanned), body.distance, body.half_side);
    EXPECT_LT(after.normals, 0.5 * before.normals) << body.name;
    EXPECT_LT(after.place, 1.2 * before.place) << body.name;
    std::cout << scanner.name << ' ' << body.name << ": normals " << before.normals << " -> "
              << after.normals << " degrees, place " << before.place << " -> " << after.place
              << " mm\n";
  }
}

INSTANTIATE_TEST_SUITE_P(Scanners, UpsampleSurfaces,
                         testing::Values(Scanner{"Cubes1mm", Vec3(1), 1},
                                         Scanner{"Cubes3mm", Vec3(3), 1},
                                         Scanner{"Cubes3mm8bit", Vec3(3), 16},
                                         Scanner{"Slices3mm", Vec3(0.8f, 0.8f, 3), 1},
                                         Scanner{"Slices3mm8bit", Vec3(0.8f, 0.8f, 3), 16},
                                         Scanner{"Slices5mm", Vec3(0.8f, 0.8f, 5), 1}),
                         [](const auto& scanner) { return std::string(scanner.param.name); });

/// A ball of two or three voxels' radius in a small volume, with noise.
Volume small_ball(float noise = 0) {
  TestScan how;
  how.spacing = Vec3(1, 1, 2);
  how.half_side = 5;
  how.noise = noise;
  return scan(ball(2.6f), how);
}

TEST(Upsample, EvenMatterStaysAsScanned) {
  Volume volume = small_ball(15);
  const Volume fine = upsample(volume, {2, 3, 4}, TransferFunction({{-2000, {Vec3(1), 1}}}));
  EXPECT_EQ(fine.dims, (volume.dims - 1) * IVec3(2, 3, 4) + 1);
  const float rounding = (volume.values.range().max - volume.values.range().min) / 65535;
  for (int i = 0; i < 300; ++i) {
    const Vec3 at = volume.world_from_index(
        Vec3(volume.dims - 1) * fibonacci_sphere(i, 300) * 0.5f + 0.5f * Vec3(volume.dims - 1));
    const Vec3 node = glm::round(fine.index_from_world(at));
    const IVec3 n(node);
    EXPECT_NEAR(fine.at(n.x, n.y, n.z), volume.sample(fine.world_from_index(node)), rounding);
  }
}

TEST(Upsample, KeepsThePlaceTheScanAndTheLabels) {
  Volume volume = small_ball();
  volume.labels.assign(volume.voxels(), 0);
  volume.labels[volume.offset(6, 6, 3)] = 1;
  volume.label_numbers = {0, 7};
  const Volume fine = upsample(volume, {2, 1, 3}, skin());
  EXPECT_EQ(fine.origin, volume.origin);
  EXPECT_LT(glm::length(fine.scanned_spacing() - volume.spacing), 1e-6f);
  const auto bounds = fine.bounds();
  EXPECT_LT(glm::length(bounds.max - volume.bounds().max), 1e-4f);
  EXPECT_EQ(std::ranges::count(fine.labels, 1), 1 * 1 * 3 + 1 * 3);  // half of what lies between
  EXPECT_EQ(fine.labels[fine.offset(12, 6, 9)], 1);
}

/// upsample() as its header says it, in double precision, voxel by voxel.
class PlainFlow {
 public:
  PlainFlow(const Volume& volume, const IVec3& factors) : volume_(volume), factors_(factors) {
    dims_ = (volume.dims - 1) * factors + 1;
    values_.resize(static_cast<size_t>(dims_.x) * dims_.y * dims_.z);
    freedom_.resize(values_.size());
    each([&](const IVec3& at) { freedom_[offset(at)] = find_freedom(at); });
    each([&](const IVec3& at) { value(at) = interpolated(at); });
    for (int round = 0; round < 8; ++round) {
      keep_means();
      for (int step = 0; step < 10; ++step) {
        flow(1);
      }
    }
    for (int step = 0; step < 3; ++step) {
      flow(0);
    }
    keep_thin_things();
  }

  double& value(const IVec3& at) { return values_[offset(at)]; }
  const IVec3& dims() const { return dims_; }

  template <typename Use>
  void each(const Use& use) const {
    for (int z = 0; z < dims_.z; ++z) {
      for (int y = 0; y < dims_.y; ++y) {
        for (int x = 0; x < dims_.x; ++x) {
          use(IVec3(x, y, z));
        }
      }
    }
  }

 private:
  using DVec3 = glm::dvec3;
  using Scanned = std::function<double(const IVec3&)>;

  size_t offset(const IVec3& at) const {
    return (static_cast<size_t>(at.z) * dims_.y + at.y) * dims_.x + at.x;
  }

  double scanned(const IVec3& at) const {
    const IVec3 p = glm::clamp(at, IVec3(0), volume_.dims - 1);
    return static_cast<double>(volume_.at(p.x, p.y, p.z));
  }

  /// Separable weights of the scanned voxels from one before to two after.
  double weighted(const IVec3& at, const Scanned& of,
                  const std::function<std::array<double, 4>(double)>& weights) const {
    const IVec3 low = at / factors_;
    std::array<std::array<double, 4>, 3> w;
    for (int k = 0; k < 3; ++k) {
      w[static_cast<size_t>(k)] =
          weights(static_cast<double>(at[k] % factors_[k]) / static_cast<double>(factors_[k]));
    }
    double sum = 0;
    for (int k = 0; k < 64; ++k) {
      const IVec3 i(k % 4, k / 4 % 4, k / 16);
      sum += w[0][static_cast<size_t>(i.x)] * w[1][static_cast<size_t>(i.y)] *
             w[2][static_cast<size_t>(i.z)] *
             of(glm::clamp(low + i - 1, IVec3(0), volume_.dims - 1));
    }
    return sum;
  }
  double linear(const IVec3& at, const Scanned& of) const {
    return weighted(at, of, [](double t) { return std::array{0.0, 1 - t, t, 0.0}; });
  }
  double linear(const IVec3& at) const {
    return linear(at, [this](const IVec3& i) { return scanned(i); });
  }
  double cubic(const IVec3& at) const {
    return weighted(
        at, [this](const IVec3& i) { return scanned(i); },
        [](double t) {
          return std::array{0.5 * (-t + 2 * t * t - t * t * t),
                            0.5 * (2 - 5 * t * t + 3 * t * t * t),
                            0.5 * (t + 4 * t * t - 3 * t * t * t), 0.5 * (-t * t + t * t * t)};
        });
  }

  /// Least and largest of the 27 scanned voxels.
  std::pair<double, double> around(const IVec3& at) const {
    double least = scanned(at);
    double most = least;
    for (int i = 0; i < 27; ++i) {
      const double v = scanned(at + IVec3(i % 3, i / 3 % 3, i / 9) - 1);
      least = std::min(least, v);
      most = std::max(most, v);
    }
    return {least, most};
  }

  /// Without noise a surface is wherever skin and air are together.
  double surface(const IVec3& at) const {
    const auto [least, most] = around(at);
    return least <= -300 && most > -300 ? 1 : 0;
  }
  double freedom(const IVec3& at) const { return freedom_[offset(at)]; }
  double find_freedom(const IVec3& at) const {
    return std::round(255 * linear(at, [this](const IVec3& i) { return surface(i); })) / 255;
  }

  double in_range(double value, const IVec3& at) const {
    return std::clamp(value, linear(at, [&](const IVec3& i) { return around(i).first; }),
                      linear(at, [&](const IVec3& i) { return around(i).second; }));
  }

  double interpolated(const IVec3& at) const {
    return glm::mix(linear(at), in_range(cubic(at), at), freedom(at));
  }

  double mean_over(const IVec3& at) {
    double sum = 0;
    double weights = 0;
    const IVec3 centre = at * factors_;
    each([&](const IVec3& i) {
      double weight = 1;
      for (int k = 0; k < 3; ++k) {
        const double off = std::abs(i[k] - centre[k]) / (0.5 * factors_[k]);
        weight *= off < 1 - 1e-9 ? 1 : off < 1 + 1e-9 ? 0.5 : 0;
      }
      sum += weight * value(i);
      weights += weight;
    });
    return sum / weights;
  }

  bool inner(const IVec3& at) const {
    return glm::all(glm::greaterThan(at, IVec3(0))) && glm::all(glm::lessThan(at, dims_ - 1));
  }

  /// What a function says of every scanned voxel.
  Scanned table(const Scanned& of) const {
    std::vector<double> values;
    for (size_t i = 0; i < volume_.voxels(); ++i) {
      const auto n = static_cast<int>(i);
      const IVec3& dims = volume_.dims;
      values.push_back(of({n % dims.x, n / dims.x % dims.y, n / (dims.x * dims.y)}));
    }
    return [this, values](const IVec3& at) { return values[volume_.offset(at.x, at.y, at.z)]; };
  }
  Scanned missing() {
    return table(
        [this](const IVec3& at) { return surface(at) > 0 ? scanned(at) - mean_over(at) : 0; });
  }

  void keep_means() {
    const Scanned off = missing();
    each([&](const IVec3& at) {
      if (inner(at) && freedom(at) > 0) {
        value(at) = in_range(value(at) + freedom(at) * linear(at, off), at);
      }
    });
  }

  void keep_thin_things() {
    const Scanned off = missing();
    const Scanned lost = [&](const IVec3& at) {
      const auto [least, most] = around(at);
      return surface(at) > 0 ? glm::smoothstep(0.25, 0.4, std::abs(off(at)) / (most - least)) : 0;
    };
    const Scanned near = table([&](const IVec3& at) {
      double most = 0;
      for (int i = 0; i < 27; ++i) {
        const IVec3 there = at + IVec3(i % 3, i / 3 % 3, i / 9) - 1;
        most = std::max(most, lost(glm::clamp(there, IVec3(0), volume_.dims - 1)));
      }
      return most;
    });
    each([&](const IVec3& at) {
      if (inner(at) && freedom(at) > 0) {
        value(at) = glm::mix(value(at), interpolated(at), linear(at, near));
      }
    });
  }

  void flow(double normal) {
    const DVec3 h = DVec3(volume_.spacing) / DVec3(factors_);
    const double finest = std::min({h.x, h.y, h.z});
    std::vector<double> next = values_;
    each([&](const IVec3& at) {
      if (!inner(at)) {
        return;
      }
      DVec3 gradient;
      glm::dmat3 hessian;
      for (int a = 0; a < 3; ++a) {
        IVec3 i(0);
        i[a] = 1;
        gradient[a] = (value(at + i) - value(at - i)) / (2 * h[a]);
        hessian[a][a] = (value(at + i) + value(at - i) - 2 * value(at)) / (h[a] * h[a]);
        for (int b = 0; b < a; ++b) {
          IVec3 j(0);
          j[b] = 1;
          hessian[a][b] = hessian[b][a] =
              (value(at + i + j) - value(at + i - j) - value(at - i + j) + value(at - i - j)) /
              (4 * h[a] * h[b]);
        }
      }
      const double steep = glm::dot(gradient, gradient);
      const double along = steep > 0 ? glm::dot(gradient, hessian * gradient) / steep : 0;
      next[offset(at)] += 0.16 * finest * finest * freedom(at) *
                          (hessian[0][0] + hessian[1][1] + hessian[2][2] - normal * along);
    });
    values_ = std::move(next);
  }

  const Volume& volume_;
  IVec3 factors_;
  IVec3 dims_;
  std::vector<double> values_;
  std::vector<double> freedom_;  // 0…1
};

TEST(Upsample, IsWhatThePlainComputationSays) {
  const Volume volume = small_ball();
  const IVec3 factors(2, 1, 3);
  const Volume fine = upsample(volume, factors, skin());
  PlainFlow plain(volume, factors);
  ASSERT_EQ(fine.dims, plain.dims());
  double worst = 0;
  plain.each([&](const IVec3& at) {
    worst =
        std::max(worst, std::abs(static_cast<double>(fine.at(at.x, at.y, at.z)) - plain.value(at)));
  });
  EXPECT_LT(worst, 1) << "HU of 1040";
}

TEST(Upsample, BytesDoNotDependOnThreads) {
  const Volume volume = small_ball(15);
  set_thread_count(1);
  const Volume one = upsample(volume, {3, 3, 3}, skin());
  set_thread_count(3);
  const Volume three = upsample(volume, {3, 3, 3}, skin());
  set_thread_count(0);
  EXPECT_TRUE(one.values == three.values);
}

TEST(Upsample, ThinThingsStay) {
  // A tube two voxels wide keeps its brightest value; a sheet of one voxel stays closed.
  TestScan how;
  how.half_side = 12;
  how.inside = 300;
  how.outside = 40;
  const TransferFunction contrast({{120, {Vec3(1), 0}}, {170, {Vec3(1), 2}}});
  const Volume tube = scan(
      [](const Vec3& p) {
        return glm::length(p - p.y * glm::normalize(Vec3(0.3f, 1, 0.2f))) - 1.0f;
      },
      how);
  const Volume fine = upsample(tube, IVec3(2), contrast);
  EXPECT_GT(fine.sample(Vec3(0)), 0.85f * tube.sample(Vec3(0)));
  const Volume sheet = scan([](const Vec3& p) { return std::abs(p.x + 0.1f * p.y) - 0.5f; }, how);
  const Volume thin = upsample(sheet, IVec3(2), contrast);
  for (float y = -8; y <= 8; y += 0.5f) {
    EXPECT_GT(thin.sample(Vec3(-0.1f * y, y, 0.3f * y)), 120) << y;
  }
}

TEST(Upsample, LeavesOutPlanesThatShowNothing) {
  TestScan how;
  how.half_side = 20;
  const Volume volume = scan(ball(8), how);
  const Volume fine = upsample(volume, skin());
  EXPECT_LT(fine.dims.x, (volume.dims.x - 10) * fine.upsampling.x);
  EXPECT_GT(fine.dims.x / fine.upsampling.x, 18);
  for (const Vec3& at : {Vec3(0), Vec3(5, -3, 2), Vec3(0, 0, -5)}) {
    EXPECT_NEAR(fine.sample(at), 40, 1);
  }
  // All of it, where nothing is shown, or everything.
  EXPECT_EQ(upsample(volume, TransferFunction({{500, {Vec3(1), 0}}, {600, {Vec3(1), 1}}})).dims,
            (volume.dims - 1) * fine.upsampling + 1);
}

TEST(Upsample, FactorsSuitTheScan) {
  const auto factors = [](const IVec3& dims, const Vec3& spacing, bool rgb = false) {
    return upsampling_factors({.dims = dims, .rgb = rgb, .spacing = spacing});
  };
  EXPECT_EQ(factors({122, 101, 112}, Vec3(3)), IVec3(3));
  EXPECT_EQ(factors({512, 512, 80}, Vec3(0.7f, 0.7f, 3)), IVec3(1, 1, 4));
  EXPECT_EQ(factors({256, 256, 275}, Vec3(1.56f, 1.56f, 1)), IVec3(2, 2, 1));
  EXPECT_EQ(factors({188, 256, 190}, Vec3(0.88f)), IVec3(2));
  EXPECT_EQ(factors({365, 236, 234}, Vec3(1)), IVec3(2));
  EXPECT_EQ(factors({128, 128, 256}, Vec3(1)), IVec3(2)) << "a third of 1 mm would not be seen";
  EXPECT_EQ(factors({210, 256, 179}, Vec3(0.1f)), IVec3(2)) << "small things are magnified";
  EXPECT_EQ(factors({512, 512, 900}, Vec3(0.7f, 0.7f, 0.7f)), IVec3(1)) << "large enough";
  EXPECT_EQ(factors({100, 100, 20}, Vec3(1, 1, 40)), IVec3(1, 1, 6)) << "no slice is bridged so";
  EXPECT_EQ(factors({122, 101, 112}, Vec3(3), true), IVec3(1)) << "photographs";
}

TEST(Upsample, LeavesOutWhatIsReadAndNotDrawn) {
  Volume volume = small_ball();
  volume.scanned = volume.values;
  volume.values.transform([](float value) { return 0.5f * value; });
  for (const int factor : {1, 2}) {
    const Volume fine = upsample(volume, IVec3(factor), skin());
    EXPECT_TRUE(fine.scanned.empty()) << factor;
    EXPECT_EQ(fine.readings(), fine.values) << factor;
  }
  VolumeSize size{.dims = {122, 101, 112}, .spacing = Vec3(3)};
  const std::uint64_t drawn = most_upsampled(size).loaded();
  size.scanned = true;
  EXPECT_EQ(most_upsampled(size).loaded(), drawn);
}

TEST(Upsample, RefusesFactorsBelowOne) {
  EXPECT_THROW(upsample(small_ball(), {1, 0, 1}, skin()), Error);
}

TEST(Upsample, FlatVolumesAndOnesMadeOfOneValuePass) {
  Volume flat;
  flat.dims = IVec3(5, 5, 1);
  flat.values = std::vector<float>(25, 100);
  const Volume fine = upsample(flat, IVec3(2), skin());
  EXPECT_EQ(fine.dims, IVec3(9, 9, 1));
  EXPECT_EQ(fine.at(3, 4, 0), 100);
}

}  // namespace
}  // namespace clipgs
