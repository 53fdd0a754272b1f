#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/cut.h"

namespace clipgs {

struct Scene;

/// What a plane leaves of a Gaussian, by its layer (method.md §3, layers).
enum class LayerPart {
  kOff,    ///< not drawn
  kCut,    ///< of the slab that the plane goes through: cut per pixel
  kWhole,  ///< drawn as if nothing were cut
};

/// The rendering layers of a scene as a plane across its axis switches them.
struct LayerSwitch {
  /// Of each Gaussian; empty: all are cut.
  // NOLINTNEXTLINE(readability-redundant-member-init): GCC warns of designated initializers
  std::span<const std::uint16_t> layers{};
  int slab = 0;             ///< the layer whose slab the plane goes through
  bool keeps_below = true;  ///< whether layers below that one are whole

  LayerPart part(size_t gaussian) const {
    const int beyond = layers.empty() ? 0
                       : keeps_below  ? layers[gaussian] - slab
                                      : slab - layers[gaussian];
    return beyond > 0 ? LayerPart::kOff : beyond < 0 ? LayerPart::kWhole : LayerPart::kCut;
  }
};

/// Whether the layers of a scene that has some can draw `cut`: one plane across the scene's axis
/// that keeps the side that its states keep, or none.
bool switches_layers(const Scene& scene, const Cut& cut);

/// The layers of `scene` at `cut`, which refers to those of the scene. Throws Error for a scene
/// without layers and a cut that they cannot draw.
LayerSwitch switch_layers(const Scene& scene, const Cut& cut);

}  // namespace clipgs
