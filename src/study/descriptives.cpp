#include "study/descriptives.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/error.h"

namespace clipgs {

double quantile(std::span<const double> ascending, double share) {
  const double place = share * static_cast<double>(ascending.size() - 1);
  const auto below = static_cast<size_t>(place);
  const size_t above = std::min(below + 1, ascending.size() - 1);
  const double part = place - static_cast<double>(below);
  return ascending[below] + part * (ascending[above] - ascending[below]);
}

double t_critical(double df, double alpha) {
  const boost::math::students_t distribution(df);
  return boost::math::quantile(boost::math::complement(distribution, alpha / 2));
}

Descriptives describe(std::span<const double> values, double alpha) {
  if (values.empty() || !std::ranges::all_of(values, [](double v) { return std::isfinite(v); })) {
    throw Error("statistics need at least one value, and finite ones; check the data");
  }
  std::vector<double> sorted(values.begin(), values.end());
  std::ranges::sort(sorted);  // sums, too, do not depend on the order then
  Descriptives result;
  result.n = sorted.size();
  const auto n = static_cast<double>(result.n);
  result.min = sorted.front();
  result.max = sorted.back();
  result.median = quantile(sorted, 0.5);
  result.q1 = quantile(sorted, 0.25);
  result.q3 = quantile(sorted, 0.75);
  // Equal values have their own value for a mean, not one rounded on the way.
  result.mean = result.min == result.max ? result.min
                                         : std::accumulate(sorted.begin(), sorted.end(), 0.0) / n;
  if (result.n > 1) {
    double squares = 0;
    for (const double value : sorted) {
      squares += (value - result.mean) * (value - result.mean);
    }
    result.sd = std::sqrt(squares / (n - 1));
    const double half = t_critical(n - 1, alpha) * *result.sd / std::sqrt(n);
    result.mean_ci = Interval{result.mean - half, result.mean + half};
  }
  return result;
}

}  // namespace clipgs
