#include "splat/layer_switch.h"

#include "core/error.h"
#include "splat/scene.h"

namespace clipgs {

namespace {

/// A normal along the axis lies within a part of a degree of it.
constexpr float kSameNormal = 0.99999f;

}  // namespace

bool switches_layers(const Scene& scene, const Cut& cut) {
  if (cut.empty()) {
    return true;
  }
  const Vec3 kept = scene.states.keeps_below ? -scene.axis : scene.axis;
  return cut.planes().size() == 1 && glm::dot(cut.planes()[0].normal, kept) > kSameNormal;
}

LayerSwitch switch_layers(const Scene& scene, const Cut& cut) {
  if (scene.layers.empty()) {
    throw Error(
        "the scene has no layers; clipgs bake makes them of a neural model, or choose another clip "
        "operator");
  }
  if (!switches_layers(scene, cut)) {
    const Vec3 kept = scene.states.keeps_below ? -scene.axis : scene.axis;
    throw Error(
        "layers are switched by one plane of normal {:g},{:g},{:g}; choose another clip operator "
        "for other cuts",
        kept.x + 0, kept.y + 0, kept.z + 0);
  }
  if (cut.empty()) {
    return {};
  }
  const float offset = cut.planes()[0].offset;
  return {scene.layers, scene.states.slab_at(scene.states.keeps_below ? -offset : offset),
          scene.states.keeps_below};
}

}  // namespace clipgs
