#include "bake/bake.h"

#include <algorithm>

namespace clipgs {

namespace {

/// Without SH above order 0, which no state changes.
Gaussians explicit_part(const Gaussians& gaussians) {
  Gaussians result(gaussians.size(), 0);
  std::copy_n(gaussians.data().begin(), result.data().size(), result.data().begin());
  return result;
}

}  // namespace

BakedScene bake(const UniaxialModel& model, int state_count, float slab_depth,
                const BakeProgress& progress) {
  const Scene& scene = model.scene;
  const PlaneStates states = choose_states(model, state_count);
  const Gaussians gaussians = explicit_part(scene.gaussians);
  const float depth = slab_depth * (scene.extent.y - scene.extent.x);
  Consolidator consolidator(gaussians.size(), scene.axis, states, depth);
  UniaxialState state;
  for (int k = 0; k < states.count; ++k) {
    const Plane plane = states.plane(scene.axis, states.position(k));
    make_state(gaussians, model.parameters, plane.offset, state);
    consolidator.add(k, state.gaussians, state.ids);
    if (progress) {
      progress(static_cast<size_t>(k) + 1, static_cast<size_t>(states.count));
    }
  }
  return consolidator.finish(scene);
}

}  // namespace clipgs
