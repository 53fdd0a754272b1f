#include "train/densification.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/parallel.h"

namespace clipgs {

namespace {

float logit(float p) { return std::log(p / (1 - p)); }

/// Draws `count` indices from `alive` with probability ∝ opacity·need (cumulative sums, binary
/// search); those of one that has been drawn kMostSplits times are left out.
std::vector<std::uint32_t> draw_sources(const Gaussians& gaussians,
                                        const std::vector<std::uint32_t>& alive,
                                        const std::vector<float>& need, size_t count, Rng& rng) {
  // So small that it counts only where nothing has a need.
  constexpr double kLeastNeed = 1e-30;
  std::vector<double> cumulative;
  cumulative.reserve(alive.size());
  double total = 0;
  for (const std::uint32_t i : alive) {
    total += gaussians.opacity(i) * (need[i] + kLeastNeed);
    cumulative.push_back(total);
  }
  std::vector<std::uint32_t> sources;
  sources.reserve(count);
  std::vector<int> drawn(alive.size(), 0);
  for (size_t k = 0; k < count; ++k) {
    const double u = static_cast<double>(rng.next()) * 0x1p-32 * total;
    const auto it = std::ranges::upper_bound(cumulative, u);
    const auto at = std::min<size_t>(it - cumulative.begin(), alive.size() - 1);
    if (++drawn[at] <= Densification::kMostSplits) {
      sources.push_back(alive[at]);
    }
  }
  return sources;
}

/// Makes two of Gaussian `source`, side by side along its longest axis; the second is `target`.
void split(Gaussians& gaussians, std::uint32_t source, std::uint32_t target) {
  const Vec3 scale = gaussians.scale(source);
  int longest = 0;
  for (int a = 1; a < 3; ++a) {
    if (scale[a] > scale[longest]) {
      longest = a;
    }
  }
  // Together they have the variance of the one.
  constexpr float kOffset = Densification::kSplitOffset;
  const Vec3 offset =
      kOffset * scale[longest] * glm::mat3_cast(gaussians.rotation(source))[longest];
  gaussians.plane(Gaussians::kLogScale + longest)[source] += 0.5f * std::log(1 - kOffset * kOffset);
  gaussians.plane(Gaussians::kOpacity)[source] =
      logit(std::clamp(Densification::kSplitOpacity * gaussians.opacity(source),
                       Densification::kDeadOpacity, 1.0f - 1e-6f));
  for (int p = 0; p < gaussians.planes(); ++p) {
    gaussians.plane(p)[target] = gaussians.plane(p)[source];
  }
  for (int a = 0; a < 3; ++a) {
    gaussians.plane(Gaussians::kMean + a)[source] += offset[a];
    gaussians.plane(Gaussians::kMean + a)[target] -= offset[a];
  }
}

/// One after the other: a source that is named often is halved again and again.
void make_copies(Gaussians& gaussians, Adam& adam, std::vector<float>& need, const Copies& made) {
  for (size_t k = 0; k < made.targets.size(); ++k) {
    const std::uint32_t source = made.sources[k];
    const std::uint32_t target = made.targets[k];
    split(gaussians, source, target);
    need[source] *= 0.5f;
    need[target] = need[source];
    adam.reset(source);
    adam.reset(target);
  }
}

}  // namespace

Copies relocate_dead(Gaussians& gaussians, Adam& adam, std::vector<float>& need, Rng rng) {
  std::vector<std::uint32_t> dead;
  std::vector<std::uint32_t> alive;
  for (size_t i = 0; i < gaussians.size(); ++i) {
    const bool is_dead = !(gaussians.opacity(i) > Densification::kDeadOpacity);
    (is_dead ? dead : alive).push_back(static_cast<std::uint32_t>(i));
  }
  if (dead.empty() || alive.empty()) {
    return {};
  }
  Copies made{std::move(dead), {}};
  made.sources = draw_sources(gaussians, alive, need, made.targets.size(), rng);
  made.targets.resize(made.sources.size());
  make_copies(gaussians, adam, need, made);
  return made;
}

Copies grow(Gaussians& gaussians, Adam& adam, std::vector<float>& need, size_t budget, Rng rng) {
  const size_t old_size = gaussians.size();
  const size_t size = std::min(budget, old_size + old_size / Densification::kGrowthDivisor);
  if (size <= old_size) {
    return {};
  }
  std::vector<std::uint32_t> alive(old_size);
  std::iota(alive.begin(), alive.end(), 0U);
  Copies made;
  made.sources = draw_sources(gaussians, alive, need, size - old_size, rng);
  made.targets.resize(made.sources.size());
  std::iota(made.targets.begin(), made.targets.end(), static_cast<std::uint32_t>(old_size));
  const size_t new_size = old_size + made.targets.size();
  gaussians = resized(gaussians, new_size);
  adam.resize(new_size);
  need.resize(new_size);
  make_copies(gaussians, adam, need, made);
  return made;
}

void add_noise(Gaussians& gaussians, float rate, std::uint64_t seed, std::uint64_t step) {
  constexpr size_t kGrain = 4096;
  parallel_for(gaussians.size(), kGrain, [&](size_t begin, size_t end) {
    Rng rng(Rng::mix(seed) ^ step, begin);
    for (size_t i = begin; i < end; ++i) {
      // A steep sigmoid: 1 for dead Gaussians, 0 above an opacity of a few percent.
      const float fade = 1 / (1 + std::exp(100 * (gaussians.opacity(i) - 0.005f)));
      if (fade < 1e-4f) {
        continue;
      }
      const Vec3 noise(rng.normal(), rng.normal(), rng.normal());
      const Vec3 offset =
          gaussians.covariance(i) * noise * (fade * Densification::kNoiseRate * rate);
      for (int a = 0; a < 3; ++a) {
        gaussians.plane(Gaussians::kMean + a)[i] += offset[a];
      }
    }
  });
}

}  // namespace clipgs
