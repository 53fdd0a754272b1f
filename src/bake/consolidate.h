#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bake/states.h"

namespace clipgs {

/// Planes of a Gaussian that differ from state to state or are needed by every renderer: mean,
/// scales, rotation, opacity, SH of order 0. All states share what lies above.
constexpr int kExplicitPlanes = Gaussians::planes(0);

/// Logit of the opacity 1/255: renderers draw nothing fainter.
constexpr float kVisibleLogit = -5.5373343f;

/// Where what one plane state shows comes from.
struct StateStatistics {
  size_t shown = 0;      ///< primitives that the state shows
  size_t in_slab = 0;    ///< of them, those whose centre lies in the state's slab
  size_t from_slab = 0;  ///< of them, those that the scene has from this state
};

/// What consolidation found and kept.
struct BakeStatistics {
  size_t primitives = 0;  ///< of the model
  // Where each primitive of the scene comes from:
  size_t from_slab = 0;     ///< a state in whose slab it lies
  size_t from_nearest = 0;  ///< the nearest state that shows it; it is in no slab of its own
  size_t from_uncut = 0;    ///< the uncut scene; no state shows it
  std::vector<StateStatistics> states;

  // Bytes that each stage of ClipGS-VR would take as raw floats.
  std::uintmax_t raw_bytes = 0;           ///< a 3DGS PLY of every primitive for each state
  std::uintmax_t shared_sh_bytes = 0;     ///< the same, SH above order 0 once for all states
  std::uintmax_t slab_bytes = 0;          ///< of each state its slab, shared SH once
  std::uintmax_t consolidated_bytes = 0;  ///< the scene, with two bytes of layer a primitive

  size_t kept() const { return from_slab + from_nearest + from_uncut; }
};

/// A scene with states and layers.
struct BakedScene {
  Scene scene;
  BakeStatistics statistics;
};

/// Makes one scene of plane states that are shown to it one after the other (ClipGS-VR). Each
/// primitive that a state shows is in the scene once: as the state has it in whose slab its centre
/// lies there (in several: where it lies most central), else as the nearest state has it, by the
/// distance of its centre from the state's slab. Ties go to the state that came first. A primitive
/// counts as shown if its opacity is 1/255 or more. Holds one state's worth of memory, however many
/// there are; the result does not depend on the number of threads.
class Consolidator {
 public:
  /// `primitives`: of the model. `axis`: see PlaneStates. `depth`: see Slab.
  Consolidator(size_t primitives, const Vec3& axis, const PlaneStates& states, float depth = 0);

  /// Adds state `k`, each once and in ascending order. `ids`: of each Gaussian its index in the
  /// model, each at most once. SH above order 0 may be absent and are not looked at.
  void add(int k, const Gaussians& gaussians, std::span<const std::uint32_t> ids);

  /// The scene. All but Gaussians, states and layers come from `uncut`, whose Gaussians are all
  /// primitives of the model: their SH above order 0 are everybody's, and those that no state has
  /// shown, but that are visible in it, are taken from it; their layer is the state whose slab is
  /// nearest. With deep slabs that is everybody's layer. Primitives keep the model's order.
  BakedScene finish(Scene uncut);

 private:
  enum class Source : std::uint8_t { kNone, kNearest, kSlab, kUncut };

  void take(std::uint32_t id, const Gaussians& from, size_t index);
  void take_unseen(const Gaussians& uncut);
  void count_sources(size_t kept, int sh_degree);

  Vec3 axis_;
  PlaneStates states_;
  Slab slab_;
  // Of each primitive: its best version so far.
  Gaussians best_;
  std::vector<Source> sources_;
  std::vector<float> off_slab_;  // mm
  std::vector<std::uint16_t> layers_;
  BakeStatistics statistics_;
};

}  // namespace clipgs
