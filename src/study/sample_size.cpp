#include "study/sample_size.h"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <boost/math/distributions/non_central_t.hpp>
#include <cmath>

#include "core/error.h"
#include "study/descriptives.h"

namespace clipgs {

void require_valid(const PowerTarget& target) {
  if (!(target.alpha > 0 && target.power > target.alpha && target.power < 1)) {
    throw Error("a power of {} at alpha {} is no aim; choose 0 < alpha < power < 1", target.power,
                target.alpha);
  }
}

double paired_t_power(double dz, size_t n, double alpha) {
  const auto df = static_cast<double>(n - 1);
  const boost::math::non_central_t distribution(df, dz * std::sqrt(static_cast<double>(n)));
  const double critical = t_critical(df, alpha);
  return boost::math::cdf(distribution, -critical) +
         boost::math::cdf(boost::math::complement(distribution, critical));
}

std::optional<size_t> paired_t_sample_size(double dz, const PowerTarget& target) {
  require_valid(target);
  if (!std::isfinite(dz)) {
    throw Error("an effect of {} cannot be planned for; give a d_z like 0.5", dz);
  }
  const double effect = std::min(std::abs(dz), kLargestEffect);
  if (effect < kLeastEffect) {
    return std::nullopt;
  }
  size_t enough = 2;
  while (paired_t_power(effect, enough, target.alpha) < target.power) {
    enough *= 2;
  }
  size_t too_few = enough / 2;  // or 1, which is no sample
  while (enough - too_few > 1) {
    const size_t middle = (enough + too_few) / 2;
    (paired_t_power(effect, middle, target.alpha) < target.power ? too_few : enough) = middle;
  }
  return enough;
}

std::optional<size_t> wilcoxon_sample_size(double dz, const PowerTarget& target) {
  const std::optional<size_t> pairs = paired_t_sample_size(dz, target);
  if (!pairs) {
    return std::nullopt;
  }
  const double efficiency = 3 / boost::math::constants::pi<double>();
  const double fewest = std::log2(2 / target.alpha);
  return static_cast<size_t>(std::ceil(std::max(fewest, static_cast<double>(*pairs) / efficiency)));
}

}  // namespace clipgs
