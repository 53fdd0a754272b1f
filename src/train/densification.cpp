#include "train/densification.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.h"

namespace clipgs {

namespace {

constexpr int kMaxCopies = 51;

/// Equation 9 of 3DGS-MCMC: what opacity and scale factor N coincident copies need to look like the
/// one they replace.
struct SharedLook {
  float opacity;
  float scale;
};

SharedLook share(float opacity, int copies) {
  const double each = 1.0 - std::pow(1.0 - opacity, 1.0 / copies);
  double denominator = 0;
  for (int i = 1; i <= copies; ++i) {
    double binomial = 1;  // C(i−1, k), built up over k
    for (int k = 0; k < i; ++k) {
      const double sign = k % 2 == 0 ? 1.0 : -1.0;
      denominator += binomial * sign * std::pow(each, k + 1) / std::sqrt(k + 1.0);
      binomial *= static_cast<double>(i - 1 - k) / (k + 1);
    }
  }
  return {static_cast<float>(each), static_cast<float>(opacity / denominator)};
}

float logit(float p) { return std::log(p / (1 - p)); }

/// Draws `count` indices from `alive` with probability ∝ opacity (cumulative sums, binary search).
std::vector<std::uint32_t> draw_sources(const Gaussians& gaussians,
                                        const std::vector<std::uint32_t>& alive, size_t count,
                                        Rng& rng) {
  std::vector<double> cumulative;
  cumulative.reserve(alive.size());
  double total = 0;
  for (const std::uint32_t i : alive) {
    total += gaussians.opacity(i);
    cumulative.push_back(total);
  }
  std::vector<std::uint32_t> sources;
  sources.reserve(count);
  for (size_t k = 0; k < count; ++k) {
    const double u = static_cast<double>(rng.next()) * 0x1p-32 * total;
    const auto it = std::ranges::upper_bound(cumulative, u);
    const auto at = std::min<size_t>(it - cumulative.begin(), alive.size() - 1);
    sources.push_back(alive[at]);
  }
  return sources;
}

/// Makes copies; each source and its copies share its look.
void make_copies(Gaussians& gaussians, Adam& adam, const Copies& made) {
  const auto& [targets, sources] = made;
  std::vector<int> copies(gaussians.size(), 1);
  for (const std::uint32_t s : sources) {
    ++copies[s];
  }
  for (const std::uint32_t s : sources) {
    if (copies[s] == 1) {
      continue;  // this source has been thinned already
    }
    const SharedLook look = share(gaussians.opacity(s), std::min(copies[s], kMaxCopies));
    gaussians.plane(Gaussians::kOpacity)[s] =
        logit(std::clamp(look.opacity, Densification::kDeadOpacity, 1.0f - 1e-6f));
    for (int a = 0; a < 3; ++a) {
      gaussians.plane(Gaussians::kLogScale + a)[s] += std::log(look.scale);
    }
    adam.reset(s);
    copies[s] = 1;
  }
  for (size_t k = 0; k < targets.size(); ++k) {
    for (int p = 0; p < gaussians.planes(); ++p) {
      gaussians.plane(p)[targets[k]] = gaussians.plane(p)[sources[k]];
    }
    adam.reset(targets[k]);
  }
}

}  // namespace

Copies relocate_dead(Gaussians& gaussians, Adam& adam, Rng rng) {
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
  made.sources = draw_sources(gaussians, alive, made.targets.size(), rng);
  make_copies(gaussians, adam, made);
  return made;
}

Copies grow(Gaussians& gaussians, Adam& adam, size_t budget, Rng rng) {
  const size_t old_size = gaussians.size();
  const size_t size = std::min(budget, old_size + old_size / Densification::kGrowthDivisor);
  if (size <= old_size) {
    return {};
  }
  std::vector<std::uint32_t> alive(old_size);
  Copies made;
  for (size_t i = 0; i < old_size; ++i) {
    alive[i] = static_cast<std::uint32_t>(i);
  }
  for (size_t i = old_size; i < size; ++i) {
    made.targets.push_back(static_cast<std::uint32_t>(i));
  }
  made.sources = draw_sources(gaussians, alive, made.targets.size(), rng);
  gaussians = resized(gaussians, size);
  adam.resize(size);
  make_copies(gaussians, adam, made);
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
