// One training step and its parts. Run: build/release/src/train/train_bench
#include <benchmark/benchmark.h>
#include <cmath>

#include "core/random.h"
#include "splat/rasterizer.h"
#include "train/adam.h"
#include "train/loss.h"

namespace clipgs {
namespace {

constexpr float kRadius = 100;  // mm

/// A solid ball of Gaussians at even density, as a volume's interior starts out.
Gaussians solid_ball(size_t count, int degree) {
  Gaussians g(count, degree);
  Rng rng(1);
  const float spacing = kRadius * std::cbrt(4.19f / static_cast<float>(count));
  for (size_t i = 0; i < count; ++i) {
    Vec3 p;
    do {
      p = 2.0f * Vec3(rng.uniform(), rng.uniform(), rng.uniform()) - Vec3(1);
    } while (glm::dot(p, p) > 1);
    for (int a = 0; a < 3; ++a) {
      g.plane(Gaussians::kMean + a)[i] = kRadius * p[a];
      g.plane(Gaussians::kLogScale + a)[i] = std::log(0.5f * spacing) + 0.2f * rng.normal();
      g.plane(Gaussians::kSh + a)[i] = rng.normal();
    }
    g.plane(Gaussians::kRotation)[i] = 1;
    g.plane(Gaussians::kOpacity)[i] = 0.4f;
  }
  return g;
}

/// arguments: picture size, Gaussians, SH degree, clipped
void training_step(benchmark::State& state) {
  const auto size = static_cast<int>(state.range(0));
  const auto count = static_cast<size_t>(state.range(1));
  const auto degree = static_cast<int>(state.range(2));
  Gaussians gaussians = solid_ball(count, degree);
  Gaussians gradients(count, degree);
  Adam adam(gaussians);
  Rasterizer rasterizer;
  ImageLoss loss;
  Image truth(size, size, 4);
  Image gradient;
  const std::optional<Plane> plane =
      state.range(3) != 0 ? std::optional(Plane{glm::normalize(Vec3(1, -2, 1)), 0}) : std::nullopt;
  int view = 0;
  for (auto _ : state) {
    const Camera camera =
        frame_sphere({Vec3(0), kRadius}, fibonacci_sphere(view++ % 50, 50), 1, size, size);
    const Image& image = rasterizer.forward(gaussians, camera, plane, {});
    loss.evaluate(image, truth, Vec3(0.5f), {}, gradient);
    rasterizer.backward(gaussians, gradient, gradients);
    adam.step(rasterizer.reached(), gradients, {1e-6f, 1e-6f, 1e-6f, 1e-6f, 1e-6f, 1e-6f},
              gaussians);
  }
  state.counters["splats/s"] =
      benchmark::Counter(static_cast<double>(count), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(training_step)
    ->ArgNames({"size", "gaussians", "degree", "clipped"})
    ->Args({512, 100000, 3, 0})
    ->Args({512, 100000, 3, 1})
    ->Args({256, 100000, 1, 1})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void forward_only(benchmark::State& state) {
  const auto size = static_cast<int>(state.range(0));
  const Gaussians gaussians = solid_ball(100000, 3);
  Rasterizer rasterizer;
  const Camera camera = frame_sphere({Vec3(0), kRadius}, View{30, 20, 1}, size, size);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        rasterizer.forward(gaussians, camera, Plane{Vec3(0, 0, 1), 0}, {}).data.data());
  }
}
BENCHMARK(forward_only)->Arg(256)->Arg(512)->Unit(benchmark::kMillisecond)->UseRealTime();

void loss_only(benchmark::State& state) {
  const auto size = static_cast<int>(state.range(0));
  Image a(size, size, 4);
  Image b(size, size, 4);
  Image gradient;
  ImageLoss loss;
  for (auto _ : state) {
    benchmark::DoNotOptimize(loss.evaluate(a, b, Vec3(0.5f), {}, gradient));
  }
}
BENCHMARK(loss_only)->Arg(512)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace clipgs

BENCHMARK_MAIN();
