// From a uniaxial model to a case, as `clipgs bake` and `clipgs pack` make it: 120,000 Gaussians of
// SH degree 3 and 200 states, with the adjustment's window and without. Run:
// build/release/src/asset/bake_bench
#include <chrono>
#include <fmt/format.h>
#include <functional>
#include <sys/resource.h>

#include "asset/case.h"
#include "bake/bake.h"
#include "bake/test_model.h"

namespace clipgs {
namespace {

constexpr size_t kCount = 120000;
constexpr int kStates = 200;

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// A model of the default adjustment's size, its weights random.
UniaxialModel full_model(float window) {
  UniaxialModel model = test::random_model(kCount, 3, window);
  AdjustmentOptions options;
  options.window = window;
  const Scene& scene = model.scene;
  model.parameters.adjustment =
      Adjustment(options, scene.sphere, scene.extent.y - scene.extent.x, 43);
  Rng rng(44);
  for (float& weight : model.parameters.adjustment->weights()) {
    weight = 0.1f * rng.normal();
  }
  return model;
}

void measure(const char* name, float window) {
  const UniaxialModel model = full_model(window);
  BakedScene baked;
  Bytes bytes;
  const double baking = seconds_of([&] { baked = bake(model, kStates); });
  const double packing = seconds_of([&] { bytes = encode_case({baked.scene}, nullptr); });
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const BakeStatistics& s = baked.statistics;
  constexpr double kMegabyte = 1e6;
  fmt::print("{:<14} bake {:6.2f} s  pack {:6.2f} s  peak {:.2f} GB\n", name, baking, packing,
             static_cast<double>(usage.ru_maxrss) * 1024 / 1e9);
  fmt::print("               kept {}: slab {}, nearest {}, uncut {}\n", s.kept(), s.from_slab,
             s.from_nearest, s.from_uncut);
  fmt::print(
      "               raw {:.1f} MB, shared SH {:.1f}, slabs {:.1f}, scene {:.1f}, case {:.1f}\n",
      static_cast<double>(s.raw_bytes) / kMegabyte,
      static_cast<double>(s.shared_sh_bytes) / kMegabyte,
      static_cast<double>(s.slab_bytes) / kMegabyte,
      static_cast<double>(s.consolidated_bytes) / kMegabyte,
      static_cast<double>(bytes.size()) / kMegabyte);
}

}  // namespace
}  // namespace clipgs

int main() {
  clipgs::measure("window 0.08", 0.08f);
  clipgs::measure("no window", 0);
}
