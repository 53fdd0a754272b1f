#include "bake/states.h"

#include "core/error.h"

namespace clipgs {

PlaneStates choose_states(const UniaxialModel& model, int count) {
  const Scene& scene = model.scene;
  const Vec3& normal = model.parameters.normal;
  constexpr float kTolerance = 1e-5f;
  const bool below = glm::length(normal + scene.axis) < kTolerance;
  if (!below && glm::length(normal - scene.axis) >= kTolerance) {
    throw Error(
        "the model's planes have the normal {}, {}, {}, its axis is {}, {}, {}; states need planes "
        "across the axis: train the model on a dataset of such planes",
        normal.x, normal.y, normal.z, scene.axis.x, scene.axis.y, scene.axis.z);
  }
  if (count < kMinStates || count > kMaxStates) {
    throw Error("{} states cannot be baked; choose {} to {}", count, kMinStates, kMaxStates);
  }
  PlaneStates states;
  states.count = count;
  states.keeps_below = below;
  states.spacing = (scene.extent.y - scene.extent.x) / static_cast<float>(count);
  if (!(states.spacing > 0)) {
    throw Error("the model's extent along its axis is empty; train it on a dataset with matter");
  }
  states.first = below ? scene.extent.x + states.spacing : scene.extent.x;
  return states;
}

}  // namespace clipgs
