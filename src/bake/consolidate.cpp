#include "bake/consolidate.h"

#include <utility>

#include "core/parallel.h"
#include "splat/ply.h"

namespace clipgs {

namespace {

constexpr size_t kPointGrain = 4096;

}  // namespace

Consolidator::Consolidator(size_t primitives, const Vec3& axis, const PlaneStates& states,
                           float depth)
    : axis_(axis),
      states_(states),
      slab_{states.spacing, depth},
      best_(primitives, 0),
      sources_(primitives, Source::kNone),
      off_slab_(primitives, 0.0f),
      layers_(primitives, 0) {
  statistics_.primitives = primitives;
  statistics_.states.resize(static_cast<size_t>(states.count));
}

void Consolidator::add(int k, const Gaussians& gaussians, std::span<const std::uint32_t> ids) {
  const Plane plane = states_.plane(axis_, states_.position(k));
  std::vector<StateStatistics> counts((ids.size() + kPointGrain - 1) / kPointGrain);
  parallel_for(ids.size(), kPointGrain, [&](size_t begin, size_t end) {
    StateStatistics& count = counts[begin / kPointGrain];
    for (size_t n = begin; n < end; ++n) {
      if (gaussians.plane(Gaussians::kOpacity)[n] < kVisibleLogit) {
        continue;
      }
      const float distance = plane.signed_distance(gaussians.mean(n));
      const Source source = slab_.holds(distance) ? Source::kSlab : Source::kNearest;
      const float off = slab_.off_middle(distance);
      ++count.shown;
      count.in_slab += source == Source::kSlab ? 1 : 0;
      const std::uint32_t id = ids[n];
      if (source > sources_[id] || (source == sources_[id] && off < off_slab_[id])) {
        sources_[id] = source;
        off_slab_[id] = off;
        layers_[id] = static_cast<std::uint16_t>(k);
        take(id, gaussians, n);
      }
    }
  });
  StateStatistics& total = statistics_.states[static_cast<size_t>(k)];
  for (const StateStatistics& count : counts) {
    total.shown += count.shown;
    total.in_slab += count.in_slab;
  }
}

void Consolidator::take(std::uint32_t id, const Gaussians& from, size_t index) {
  for (int p = 0; p < kExplicitPlanes; ++p) {
    best_.plane(p)[id] = from.plane(p)[index];
  }
}

void Consolidator::take_unseen(const Gaussians& uncut) {
  for (std::uint32_t id = 0; id < sources_.size(); ++id) {
    if (sources_[id] == Source::kNone && uncut.plane(Gaussians::kOpacity)[id] >= kVisibleLogit) {
      sources_[id] = Source::kUncut;
      layers_[id] =
          static_cast<std::uint16_t>(states_.nearest_slab(glm::dot(axis_, uncut.mean(id))));
      take(id, uncut, id);
    }
  }
}

void Consolidator::count_sources(size_t kept, int sh_degree) {
  BakeStatistics& s = statistics_;
  std::uintmax_t in_slabs = 0;
  for (size_t id = 0; id < sources_.size(); ++id) {
    s.from_slab += sources_[id] == Source::kSlab ? 1 : 0;
    s.from_nearest += sources_[id] == Source::kNearest ? 1 : 0;
    s.from_uncut += sources_[id] == Source::kUncut ? 1 : 0;
    s.states[layers_[id]].from_slab += sources_[id] == Source::kSlab ? 1 : 0;
  }
  for (const StateStatistics& state : s.states) {
    in_slabs += state.in_slab;
  }
  constexpr std::uintmax_t kExplicitBytes = kExplicitPlanes * sizeof(float);
  const std::uintmax_t shared_bytes =
      static_cast<std::uintmax_t>(Gaussians::planes(sh_degree) - kExplicitPlanes) * sizeof(float);
  const std::uintmax_t versions = s.states.size() * s.primitives;
  s.raw_bytes = versions * ply_splat_bytes(sh_degree);
  s.shared_sh_bytes = versions * kExplicitBytes + s.primitives * shared_bytes;
  s.slab_bytes = in_slabs * kExplicitBytes + s.from_slab * shared_bytes;
  s.consolidated_bytes = kept * (kExplicitBytes + shared_bytes + sizeof(std::uint16_t));
}

BakedScene Consolidator::finish(Scene uncut) {
  const Gaussians shared = std::move(uncut.gaussians);
  take_unseen(shared);
  std::vector<size_t> kept;
  for (size_t id = 0; id < sources_.size(); ++id) {
    if (sources_[id] != Source::kNone) {
      kept.push_back(id);
    }
  }
  BakedScene result{std::move(uncut), {}};
  Scene& scene = result.scene;
  scene.axis = axis_;
  scene.states = states_;
  scene.gaussians = shared.like(kept.size());
  scene.layers.resize(kept.size());
  parallel_for(kept.size(), kPointGrain, [&](size_t begin, size_t end) {
    for (int p = 0; p < scene.gaussians.planes(); ++p) {
      const float* from = p < kExplicitPlanes ? best_.plane(p) : shared.plane(p);
      for (size_t n = begin; n < end; ++n) {
        scene.gaussians.plane(p)[n] = from[kept[n]];
      }
    }
    for (size_t n = begin; n < end; ++n) {
      // A deep slab is not where its state cuts: layers are switched by where splats lie.
      const float position = glm::dot(axis_, scene.gaussians.mean(n));
      scene.layers[n] = slab_.depth > 0 ? static_cast<std::uint16_t>(states_.nearest_slab(position))
                                        : layers_[kept[n]];
    }
  });
  count_sources(kept.size(), shared.sh_degree());
  result.statistics = std::move(statistics_);
  return result;
}

}  // namespace clipgs
