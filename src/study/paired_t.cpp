#include "study/paired_t.h"

#include <algorithm>
#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>
#include <exception>

#include "core/error.h"

namespace clipgs {

namespace {

/// The noncentrality for which a noncentral t of `df` degrees of freedom stays below `t` with the
/// probability `share`, which falls as the noncentrality rises.
double noncentrality(double t, double df, double share) {
  const auto excess = [&](double delta) {
    return boost::math::cdf(boost::math::non_central_t(df, delta), t) - share;
  };
  // About the standard error of t around its noncentrality, for a first bracket.
  double reach = 3 * std::sqrt(1 + t * t / (2 * df));
  double low = t - reach;
  double high = t + reach;
  while (excess(low) < 0) {
    reach *= 2;
    low -= reach;
  }
  while (excess(high) > 0) {
    reach *= 2;
    high += reach;
  }
  std::uintmax_t steps = 200;
  const auto ends = boost::math::tools::toms748_solve(
      excess, low, high, boost::math::tools::eps_tolerance<double>(40), steps);
  return (ends.first + ends.second) / 2;
}

std::optional<Interval> effect_interval(double t, double df, double alpha) {
  try {
    const double root_n = std::sqrt(df + 1);
    return Interval{noncentrality(t, df, 1 - alpha / 2) / root_n,
                    noncentrality(t, df, alpha / 2) / root_n};
  } catch (const std::exception&) {
    // The series of a noncentral t that is far out does not converge; the test itself stands.
    return std::nullopt;
  }
}

}  // namespace

std::optional<PairedT> paired_t(std::span<const double> differences, double alpha) {
  if (differences.size() < 2) {
    throw Error("a paired t-test needs at least 2 pairs, not {}; add participants",
                differences.size());
  }
  const Descriptives all = describe(differences, alpha);
  if (!(*all.sd > 0)) {
    return std::nullopt;
  }
  PairedT result;
  result.df = static_cast<double>(all.n - 1);
  result.mean = all.mean;
  result.mean_ci = *all.mean_ci;
  result.dz = all.mean / *all.sd;
  result.t = result.dz * std::sqrt(static_cast<double>(all.n));
  const boost::math::students_t distribution(result.df);
  result.p = std::min(
      1.0, 2 * boost::math::cdf(boost::math::complement(distribution, std::abs(result.t))));
  result.dz_ci = effect_interval(result.t, result.df, alpha);
  return result;
}

}  // namespace clipgs
