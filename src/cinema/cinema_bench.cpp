#include <benchmark/benchmark.h>

#include "cinema/path_tracer.h"
#include "cinema/picture.h"
#include "cinema/reference_tracer.h"
#include "cinema/visible_matter.h"
#include "core/progress.h"
#include "volume/phantom.h"

// Time per sample (one whole camera path) on the phantom, on one thread; samples spread over the
// framed picture, those that miss included.
namespace clipgs {
namespace {

struct Fixture {
  Volume volume = make_phantom(256);
  Preset preset = load_preset("skin-and-bone");
  VisibleMatter matter = visible_matter(volume, preset.transfer);
  Camera camera = frame_sphere(matter.sphere, View{30, 15, 1}, 256, 256);
  std::optional<Plane> plane = Plane{Vec3(0, 0, -1), -matter.sphere.center.z};
};

const Fixture& fixture() {
  static const Fixture f;
  return f;
}

void fast(benchmark::State& state) {
  const Fixture& f = fixture();
  const CinemaScene scene(f.volume, f.preset);
  const PathTracer tracer(scene, f.camera, f.plane, PictureOptions().max_bounces);
  PathDraws draws(1, 0, 0);
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(tracer.trace(256 * draws.uniform(), 256 * draws.uniform(), draws));
    draws.next_sample();
  }
}

void reference(benchmark::State& state) {
  const Fixture& f = fixture();
  const ReferenceTracer tracer(f.volume, f.preset, f.camera, f.plane, PictureOptions().max_bounces);
  Rng rng(1);
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(tracer.trace(256 * rng.uniform(), 256 * rng.uniform(), rng));
  }
}

void build_scene(benchmark::State& state) {
  const Fixture& f = fixture();
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(CinemaScene(f.volume, f.preset));
  }
}

void picture_to_40_db(benchmark::State& state) {
  const Fixture& f = fixture();
  const CinemaScene scene(f.volume, f.preset);
  PictureOptions options;
  options.spp = 8192;
  options.noise_db = 40;
  double samples = 0;
  for ([[maybe_unused]] auto _ : state) {
    samples += render_picture(scene, f.camera, f.plane, options).samples;
  }
  state.counters["samples/s"] = benchmark::Counter(samples, benchmark::Counter::kIsRate);
}

BENCHMARK(fast);
BENCHMARK(reference);
BENCHMARK(build_scene)->Unit(benchmark::kMillisecond);
BENCHMARK(picture_to_40_db)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace clipgs

BENCHMARK_MAIN();
