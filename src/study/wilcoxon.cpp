#include "study/wilcoxon.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/error.h"

namespace clipgs {

namespace {

/// The ranks of what remains when zeros are dropped, ascending. Ties share a mean, which may end in
/// a half: ranks are doubled.
struct DoubledRanks {
  std::vector<int> all;
  std::int64_t plus = 0;  // of positive differences …
  std::int64_t minus = 0;
  double tie_sum = 0;  // Σ(t³ − t) over groups of ties
};

DoubledRanks rank(std::vector<double> differences) {
  std::ranges::sort(differences, {}, [](double d) { return std::abs(d); });
  DoubledRanks ranks;
  for (size_t begin = 0; begin < differences.size();) {
    size_t end = begin;
    while (end < differences.size() && std::abs(differences[end]) == std::abs(differences[begin])) {
      ++end;
    }
    const auto doubled = static_cast<int>(begin + 1 + end);
    const auto ties = static_cast<double>(end - begin);
    ranks.tie_sum += ties * ties * ties - ties;
    for (; begin < end; ++begin) {
      ranks.all.push_back(doubled);
      (differences[begin] > 0 ? ranks.plus : ranks.minus) += doubled;
    }
  }
  return ranks;
}

/// How many of the 2ⁿ ways to give the ranks signs leave at most `bound` positive, as a share.
double share_of_signs(const std::vector<int>& ranks, std::int64_t bound) {
  const int total = std::accumulate(ranks.begin(), ranks.end(), 0);
  std::vector<std::uint64_t> ways(static_cast<size_t>(total) + 1, 0);
  ways[0] = 1;
  int reach = 0;
  for (const int rank : ranks) {
    reach += rank;
    for (int sum = reach; sum >= rank; --sum) {
      ways[static_cast<size_t>(sum)] += ways[static_cast<size_t>(sum - rank)];
    }
  }
  const std::uint64_t counted =
      std::accumulate(ways.begin(), ways.begin() + bound + 1, std::uint64_t{0});
  return std::ldexp(static_cast<double>(counted), -static_cast<int>(ranks.size()));
}

}  // namespace

std::optional<Wilcoxon> wilcoxon_signed_rank(std::span<const double> differences) {
  if (differences.empty() ||
      !std::ranges::all_of(differences, [](double d) { return std::isfinite(d); })) {
    throw Error("Wilcoxon's test needs differences, and finite ones; check the data");
  }
  std::vector<double> others(differences.begin(), differences.end());
  std::erase(others, 0.0);
  if (others.empty()) {
    return std::nullopt;
  }
  const DoubledRanks ranks = rank(others);
  Wilcoxon result;
  result.n = others.size();
  result.zeros = differences.size() - others.size();
  result.plus = static_cast<double>(ranks.plus) / 2;
  result.minus = static_cast<double>(ranks.minus) / 2;
  result.w = std::min(result.plus, result.minus);
  result.r = (result.plus - result.minus) / (result.plus + result.minus);
  const auto n = static_cast<double>(result.n);
  const double variance = n * (n + 1) * (2 * n + 1) / 24 - ranks.tie_sum / 48;
  result.z = (result.w - n * (n + 1) / 4) / std::sqrt(variance);
  result.p = std::min(1.0, 2 * boost::math::cdf(boost::math::normal(), result.z));
  if (result.n <= kMostExactPairs) {
    result.exact_p =
        std::min(1.0, 2 * share_of_signs(ranks.all, std::min(ranks.plus, ranks.minus)));
  }
  return result;
}

}  // namespace clipgs
