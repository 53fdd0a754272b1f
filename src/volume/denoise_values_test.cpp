#include "volume/denoise_values.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vector>

#include "core/parallel.h"
#include "core/random.h"
#include "volume/load.h"
#include "volume/phantom.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

Volume with_noise(Volume volume, float sigma) {
  Rng rng(7);
  for (float& value : volume.values.unpack()) {
    value = std::round(value + sigma * rng.normal());
  }
  volume.values.pack();
  return volume;
}

/// Rms of the differences inside tissue, and where it ends.
struct Errors {
  double inside = 0;
  double edges = 0;
};

Errors errors(const Volume& volume, const Volume& clean) {
  std::array<double, 2> squares{};
  std::array<double, 2> counts{};
  for (int z = 1; z < clean.dims.z - 1; ++z) {
    for (int y = 1; y < clean.dims.y - 1; ++y) {
      for (int x = 1; x < clean.dims.x - 1; ++x) {
        const Vec3 slope = 0.5f * Vec3(clean.at(x + 1, y, z) - clean.at(x - 1, y, z),
                                       clean.at(x, y + 1, z) - clean.at(x, y - 1, z),
                                       clean.at(x, y, z + 1) - clean.at(x, y, z - 1));
        const float steep = glm::length(slope);  // HU a voxel
        if (clean.at(x, y, z) > -200 && (steep < 10 || steep > 60)) {
          const double difference = volume.at(x, y, z) - clean.at(x, y, z);
          squares[steep > 60 ? 1 : 0] += difference * difference;
          counts[steep > 60 ? 1 : 0] += 1;
        }
      }
    }
  }
  return {std::sqrt(squares[0] / counts[0]), std::sqrt(squares[1] / counts[1])};
}

TEST(EstimateNoise, OfThePhantomIsWhatWasAddedToItsTexture) {
  const Volume clean = make_phantom(96);
  for (const float sigma : {10.0f, 20.0f, 40.0f}) {
    EXPECT_NEAR(estimate_noise(with_noise(clean, sigma)), sigma, 0.2f * sigma) << sigma;
  }
}

TEST(DenoiseValues, LeavesLessThanHalfOfTheNoiseInsideAndLessAtEdges) {
  const Volume clean = make_phantom(96);
  for (const float sigma : {10.0f, 20.0f, 40.0f}) {
    Volume volume = with_noise(clean, sigma);
    const Errors before = errors(volume, clean);
    denoise_values(volume, sigma);
    const Errors after = errors(volume, clean);
    EXPECT_LT(after.inside, 0.45 * before.inside) << sigma;
    EXPECT_LT(after.edges, before.edges) << sigma;
    EXPECT_TRUE(volume.values.packed());
  }
}

TEST(DenoiseValues, WhatIsReadStaysAsScanned) {
  const TestFolder folder;
  Volume noisy = with_noise(make_phantom(48), 20);
  noisy.values.transform([](float value) { return std::max(value, -1024.0f); });
  save_volume(folder / "v.nrrd", noisy);
  LoadOptions options;
  options.keep_table = true;
  EXPECT_TRUE(load_volume(folder / "v.nrrd", options).scanned.empty());
  options.prepare.noise = 0;
  testing::internal::CaptureStderr();
  const LoadedVolume loaded = load_with_series(folder / "v.nrrd", options);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), testing::HasSubstr("averaged noise of 2"));
  Volume expected = noisy;
  denoise_values(expected, estimate_noise(noisy));
  EXPECT_EQ(loaded.volume.values, expected.values);
  EXPECT_EQ(loaded.volume.readings(), noisy.values);
  ASSERT_EQ(loaded.prepared.size(), 1);
  EXPECT_EQ(loaded.prepared[0].name, "denoise");
  EXPECT_NEAR(loaded.prepared[0].figures[0].second, 20, 4);
}

TEST(DenoiseValues, DoesNotDependOnThreads) {
  Volume one = with_noise(make_phantom(48), 20);
  Volume many = one;
  set_thread_count(1);
  denoise_values(one, 20);
  set_thread_count(0);
  denoise_values(many, 20);
  EXPECT_EQ(one.values, many.values);
}

TEST(DenoiseValues, AStepStaysAStep) {
  Volume step;
  step.dims = {24, 20, 12};
  std::vector<float> values;
  for (size_t i = 0; i < step.voxels(); ++i) {
    values.push_back(i % 24 < 12 ? 0.0f : 300.0f);
  }
  step.values = std::move(values);
  const VoxelValues before = step.values;
  denoise_values(step, 20);
  EXPECT_EQ(step.values, before);
}

}  // namespace
}  // namespace clipgs
