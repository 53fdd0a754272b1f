// Speed of the path tracer beside the plain reference, in one run: nanoseconds a sample, and the
// time to a picture of 35 dB. See bench/cinema.sh.
//
//   cinema_bench VOLUME PRESET [SCALE,OFFSET] [NX,NY,NZ,OFFSET]     stored → HU; the cut; "-": none
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <span>

#include "cinema/bench_subject.h"
#include "cinema/denoise.h"
#include "cinema/path_tracer.h"
#include "cinema/picture.h"
#include "cinema/reference_tracer.h"
#include "core/parallel.h"
#include "core/random.h"

namespace clipgs {
namespace {

using bench::kBounces;
using bench::Subject;
using bench::Truth;

constexpr int kSize = 512;
constexpr double kTarget = 35;  // dB
// The plain tracer is slow: it draws one row in so many, and its times are multiplied.
constexpr int kPlainEvery = 16;

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// The plain tracer's picture, of every kPlainEvery-th row: the same number of samples in every
// pixel.
Image plain_picture(const Subject& s, int spp) {
  const ReferenceTracer tracer(s.volume, s.preset, s.camera, s.cut, kBounces);
  Image sum(kSize, kSize, 4);
  parallel_for(kSize / kPlainEvery, 1, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const size_t y = row * kPlainEvery;
      for (int x = 0; x < kSize; ++x) {
        Rng rng(2, y * kSize + static_cast<size_t>(x));
        Vec4 mean(0);
        for (int i = 0; i < spp; ++i) {
          const PathSample sample = tracer.trace(static_cast<float>(x) + rng.uniform(),
                                                 static_cast<float>(y) + rng.uniform(), rng);
          mean += Vec4(sample.radiance, sample.alpha) / static_cast<float>(spp);
        }
        std::copy_n(&mean[0], 4, sum.at(x, static_cast<int>(y)));
      }
    }
  });
  return sum;
}

// The fast tracer's, likewise, for its time alone.
void uniform_picture(const Subject& s, int spp) {
  const PathTracer tracer(s.scene, s.camera, s.cut, kBounces);
  parallel_for(kSize, 4, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y) {
      std::vector<PathStart> starts;
      for (int x = 0; x < kSize; ++x) {
        Rng rng(3, y * kSize + static_cast<size_t>(x));
        for (int i = 0; i < spp; ++i) {
          starts.push_back(
              {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, rng.next(), 0});
        }
      }
      tracer.trace(starts);
    }
  });
}

// Of every `every`-th row.
double psnr(const Truth& truth, const Image& image, int every) {
  const Image shown = composite(image, 0, 0, 0);
  double sum = 0;
  size_t count = 0;
  for (int y = 0; y < kSize; y += every) {
    const float* const left = truth.shown.at(0, y);
    const float* const right = shown.at(0, y);
    for (int i = 0; i < kSize * shown.channels; ++i, ++count) {
      const double difference = left[i] - right[i];
      sum += difference * difference;
    }
  }
  return -10 * std::log10(std::max(1e-9, sum / static_cast<double>(count) - truth.error));
}

// Seconds to kTarget dB: ever more samples until it is passed, then on the straight line of dB over
// the logarithm of time. `picture` draws every `every`-th row.
double time_to_target(const Subject& s, const Truth& truth, int every,
                      const std::function<Image(int spp)>& picture) {
  double last_time = 0;
  double last_db = 0;
  for (int spp = 2; spp <= 4096; spp *= 2) {
    Image image;
    const double time = every * seconds_of([&] { image = picture(spp); });
    const double db = psnr(truth, display(image, s.preset.display()), every);
    if (db >= kTarget) {
      const double part = last_time > 0 ? (kTarget - last_db) / (db - last_db) : 1;
      return last_time > 0 ? last_time * std::pow(time / last_time, part) : time;
    }
    last_time = time;
    last_db = db;
  }
  throw Error("no picture of {} dB within 4096 samples a pixel", kTarget);
}

void run(std::span<char*> arguments) {
  const Subject s = bench::subject_of(arguments, kSize);

  // Medians of turns taken one after the other, so that both meet the same machine.
  constexpr int kTurns = 3;
  constexpr int kSpp = 8;
  std::vector<double> fast;
  std::vector<double> plain;
  std::vector<double> adaptive;
  for (int turn = 0; turn < kTurns; ++turn) {
    fast.push_back(seconds_of([&] { uniform_picture(s, kSpp); }) / kSpp);
    plain.push_back(kPlainEvery * seconds_of([&] { plain_picture(s, 2); }) / 2);
    PictureOptions options;
    options.spp = 32;
    options.max_bounces = kBounces;
    double samples = 0;
    const double time =
        seconds_of([&] { samples = render_picture(s.scene, s.camera, s.cut, options).samples; });
    adaptive.push_back(time / samples);
  }
  const auto median_ns = [](std::vector<double> values, double per) {
    std::ranges::sort(values);
    return 1e9 * values[values.size() / 2] / per;
  };
  constexpr double kPaths = kSize * kSize;

  const Truth truth = bench::converged(s, static_cast<float>(kTarget) + 10);
  const auto ours = [&](int spp, bool features) {
    PictureOptions options;
    options.spp = spp;
    options.features = features;
    options.max_bounces = kBounces;
    return render_picture(s.scene, s.camera, s.cut, options);
  };
  const double to_plain =
      time_to_target(s, truth, kPlainEvery, [&](int spp) { return plain_picture(s, spp); });
  const double to_ours =
      time_to_target(s, truth, 1, [&](int spp) { return ours(spp, false).mean(); });
  const double to_denoised = time_to_target(
      s, truth, 1, [&](int spp) { return denoise(ours(spp, true), s.preset.display()).mean(); });

  const double uniform = median_ns(fast, kPaths);
  const double reference = median_ns(plain, kPaths);
  fmt::print(
      "| {} | {:.0f} | {:.0f} | {:.0f} | {:.1f} | {:.1f} | {:.2f} ({:.0f} ×) | {:.2f} ({:.0f} ×) "
      "|\n",
      s.name(), reference, uniform, median_ns(adaptive, 1), reference / uniform, to_plain, to_ours,
      to_plain / to_ours, to_denoised, to_plain / to_denoised);
}

}  // namespace
}  // namespace clipgs

int main(int count, char** arguments) {
  return clipgs::bench::run_bench("cinema_bench", count, arguments, clipgs::run);
}
