// A picture of a face on one core.
#include <benchmark/benchmark.h>

#include "core/parallel.h"
#include "section/faces.h"
#include "volume/phantom.h"
#include "volume/preset.h"

namespace {

using clipgs::Vec3;

void face_picture(benchmark::State& state) {
  clipgs::set_thread_count(1);
  const clipgs::Volume volume = clipgs::make_phantom(256);
  const clipgs::Section section =
      clipgs::make_section(volume, clipgs::load_preset("skin-and-bone"), {});
  const auto size = static_cast<int>(state.range(0));
  const clipgs::Plane plane{glm::normalize(Vec3(0.2f, 0.3f, -1)), 0};
  const clipgs::Camera camera =
      clipgs::frame_sphere({Vec3(0), 200}, -plane.normal + Vec3(0.2f, -0.2f, 0), 1, size, size);
  clipgs::FaceOptions options;
  options.style.grey = static_cast<float>(state.range(1));
  for (auto _ : state) {
    const clipgs::Image image = clipgs::draw_faces(section, camera, plane, options);
    benchmark::DoNotOptimize(image.data.data());
  }
  const clipgs::Image image = clipgs::draw_faces(section, camera, plane, options);
  double covered = 0;
  for (size_t i = 3; i < image.data.size(); i += 4) {
    covered += image.data[i] / static_cast<double>(image.pixels());
  }
  state.counters["covered"] = covered;
}

BENCHMARK(face_picture)
    ->ArgNames({"size", "grey"})
    ->Args({1024, 0})
    ->Args({1024, 1})
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
