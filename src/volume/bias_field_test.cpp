#include "volume/bias_field.h"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "core/random.h"
#include "volume/prepare.h"
#include "volume/spline_field.h"

namespace clipgs {
namespace {

struct Body {
  Volume volume;
  std::vector<int> tissue;  ///< 0: background
};

/// Three tissues, noise, and a field that falls off to the front and top by a factor of five.
Body body() {
  Body body;
  Volume& volume = body.volume;
  volume.dims = {72, 80, 64};
  volume.spacing = {2, 2, 2};
  volume.modality = Modality::kMr;
  Rng rng(11);
  std::vector<float> values;
  for (int z = 0; z < volume.dims.z; ++z) {
    for (int y = 0; y < volume.dims.y; ++y) {
      for (int x = 0; x < volume.dims.x; ++x) {
        const Vec3 p = 2.0f * Vec3(x, y, z) / Vec3(volume.dims - 1) - 1.0f;
        const bool outside = glm::length(p / Vec3(0.8f, 0.85f, 0.9f)) > 1;
        const bool ventricle = glm::length((p - Vec3(0, 0.1f, 0)) / Vec3(0.3f, 0.4f, 0.2f)) < 1;
        // Folded as a cortex is.
        const float folds = std::sin(9 * p.x) * std::sin(8 * p.y) * std::sin(7 * p.z);
        const int tissue = outside ? 0 : ventricle ? 1 : folds > 0 ? 2 : 3;
        constexpr float kSignal[] = {0, 120, 300, 480};
        const float field =
            std::exp(-0.8f * p.y - 0.3f * p.z + 0.3f * p.x * p.y - 0.4f * p.z * p.z);
        values.push_back(std::abs(kSignal[tissue] * field + 6 * rng.normal()));
        body.tissue.push_back(tissue);
      }
    }
  }
  volume.values = std::move(values);
  return body;
}

/// Standard deviation over mean.
double variation(const Body& body, int tissue) {
  double count = 0;
  double sum = 0;
  double squares = 0;
  for (size_t i = 0; i < body.tissue.size(); ++i) {
    if (body.tissue[i] == tissue) {
      const double value = body.volume.values[i];
      count += 1;
      sum += value;
      squares += value * value;
    }
  }
  const double mean = sum / count;
  return std::sqrt(squares / count - mean * mean) / mean;
}

TEST(BiasField, AKnownOneIsEvenedOut) {
  Body scanned = body();
  const Body before = scanned;
  const BiasField field = correct_bias(scanned.volume, "test");
  EXPECT_LT(field.least, 0.6f);
  EXPECT_GT(field.most, 1.7f);
  for (const int tissue : {2, 3}) {
    EXPECT_LT(variation(scanned, tissue), variation(before, tissue) / 3) << tissue;
  }
  EXPECT_TRUE(scanned.volume.values.packed());  // 16 bits do
}

TEST(BiasField, EvenSignalStaysAsItIs) {
  Body even = body();
  Rng rng(4);
  std::vector<float>& values = even.volume.values.unpack();
  for (size_t i = 0; i < values.size(); ++i) {
    constexpr float kSignal[] = {0, 120, 300, 480};
    values[i] = std::abs(kSignal[even.tissue[i]] + 6 * rng.normal());
  }
  const BiasField field = correct_bias(even.volume, "test");
  EXPECT_GT(field.least, 0.93f);
  EXPECT_LT(field.most, 1.07f);
}

TEST(BiasField, DoesNotDependOnThreads) {
  Body one = body();
  Body many = body();
  set_thread_count(1);
  correct_bias(one.volume, "test");
  set_thread_count(0);
  correct_bias(many.volume, "test");
  EXPECT_EQ(one.volume.values, many.volume.values);
}

TEST(BiasField, NeedsASignal) {
  Body scanned = body();
  scanned.volume.values.transform([](float value) { return value - 1000; });
  EXPECT_THROW(correct_bias(scanned.volume, "test"), Error);
}

TEST(BiasField, IsRefusedWhereNoCoilsWere) {
  PrepareOptions options;
  options.bias = true;
  std::vector<PreparationStep> steps;
  Body scanned = body();
  for (const Modality modality : {Modality::kCt, Modality::kPet, Modality::kUltrasound}) {
    scanned.volume.modality = modality;
    EXPECT_THROW(prepare(scanned.volume, options, "test", steps), Error);
  }
  scanned.volume.modality = Modality::kUnknown;
  prepare(scanned.volume, options, "test", steps);
  ASSERT_EQ(steps.size(), 1);
  EXPECT_EQ(steps[0].name, "bias");
}

TEST(SplineField, StepsComeNearWhatIsSmooth) {
  const IVec3 dims(20, 16, 12);
  std::vector<float> values;
  for (int z = 0; z < dims.z; ++z) {
    for (int y = 0; y < dims.y; ++y) {
      for (int x = 0; x < dims.x; ++x) {
        const Vec3 p = Vec3(x, y, z) / Vec3(dims - 1);
        values.push_back(2 + p.x - 0.5f * p.y * p.z);
      }
    }
  }
  const std::vector<unsigned char> everywhere(values.size(), 1);
  SplineField field(4);
  const auto x = supports(field, dims.x);
  const auto y = supports(field, dims.y);
  const auto z = supports(field, dims.z);
  std::vector<float> row(x.size());
  std::vector<float> left = values;
  double squares = 0;
  for (int step = 0; step < 12; ++step) {
    field.add(approximate(dims, left, everywhere, 4));
    squares = 0;
    for (size_t i = 0; i < values.size(); i += x.size()) {
      field.evaluate_row(x, y[i / x.size() % y.size()], z[i / x.size() / y.size()], row.data());
      for (size_t k = 0; k < x.size(); ++k) {
        left[i + k] = values[i + k] - row[k];
        squares += static_cast<double>(left[i + k]) * left[i + k];
      }
    }
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(values.size())), 0.1);  // of about 2.3
}

}  // namespace
}  // namespace clipgs
