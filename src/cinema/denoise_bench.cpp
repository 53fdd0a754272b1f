// What the denoiser gains and what it costs in truth: errors of single pictures and of the mean
// over many seeds, against a converged picture of the same view. See bench/cinema.sh.
//
//   denoise_bench VOLUME PRESET [SCALE,OFFSET|-] [NX,NY,NZ,OFFSET]     stored → HU; the cut
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <vector>

#include "cinema/bench_subject.h"
#include "cinema/denoise.h"
#include "cinema/picture.h"

namespace clipgs {
namespace {

using bench::kBounces;
using bench::shown;
using bench::Subject;
using bench::Truth;

constexpr int kSize = 256;
constexpr int kSeeds = 8;
constexpr std::array kSpp = {4, 16, 64, 256};
constexpr float kConverged = 54;  // dB

/// Mean squared errors over pixels and channels.
struct Errors {
  double total;  // of one picture, mean over the seeds
  double bias;   // of the mean over ever more seeds
};

PictureOptions options_of(int spp, std::uint64_t seed) {
  PictureOptions options;
  options.spp = spp;
  options.max_bounces = kBounces;
  options.seed = seed;
  options.features = true;
  return options;
}

/// What is left of the distance between the seeds' mean and the truth when the noise of both,
/// which the scatter of the seeds tells, is taken off, is bias.
Errors errors_of(const std::vector<Image>& pictures, const Truth& truth) {
  const auto count = static_cast<double>(pictures.size());
  double total = 0;
  double bias = 0;
  for (size_t i = 0; i < truth.shown.data.size(); ++i) {
    double sum = 0;
    double squares = 0;
    for (const Image& picture : pictures) {
      const double error = picture.data[i] - truth.shown.data[i];
      sum += error;
      squares += error * error;
    }
    const double mean = sum / count;
    total += squares / count;
    bias += mean * mean - (squares / count - mean * mean) / (count - 1);
  }
  const auto values = static_cast<double>(truth.shown.data.size());
  return {total / values - truth.error, std::max(0.0, bias / values - truth.error)};
}

double decibels(double error) { return -10 * std::log10(std::max(1e-9, error)); }

void run(std::span<char*> arguments) {
  const Subject s = bench::subject_of(arguments, kSize);
  const Truth truth = bench::converged(s, kConverged);
  for (const int spp : kSpp) {
    std::vector<Image> noisy;
    std::vector<Image> denoised;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      const Picture picture = render_picture(s.scene, s.camera, s.cut,
                                             options_of(spp, static_cast<std::uint64_t>(seed)));
      noisy.push_back(shown(picture.mean(), s));
      denoised.push_back(shown(denoise(picture, s.preset.display()).mean(), s));
    }
    const Errors before = errors_of(noisy, truth);
    const Errors after = errors_of(denoised, truth);
    fmt::print("| {} | {} | {:.1f} | {:.1f} | {:+.1f} | {:.1f} | {:.0f} % |\n", s.name(), spp,
               decibels(before.total), decibels(after.total),
               decibels(after.total) - decibels(before.total), decibels(after.bias),
               100 * after.bias / after.total);
  }
}

}  // namespace
}  // namespace clipgs

int main(int count, char** arguments) {
  return clipgs::bench::run_bench("denoise_bench", count, arguments, clipgs::run);
}
