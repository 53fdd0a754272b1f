#include "volume/stack_plan.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "core/error.h"

namespace clipgs {
namespace {

/// The step most others agree with (within 5 %); the smaller one if several do.
double most_common(const std::vector<double>& steps) {
  double best = steps.front();
  std::ptrdiff_t best_count = 0;
  for (const double step : steps) {
    const auto count = std::ranges::count_if(
        steps, [&](double other) { return std::abs(other - step) < 0.05 * step; });
    if (count > best_count || (count == best_count && step < best)) {
      best = step;
      best_count = count;
    }
  }
  return best;
}

bool nearly(double a, double b) { return std::abs(a - b) < 0.05 * b; }

/// Consecutive equal steps.
struct Run {
  size_t first = 0;
  size_t count = 0;
  double step = 0;
};

std::vector<Run> runs_of(const std::vector<double>& steps) {
  std::vector<Run> runs;
  for (size_t i = 0; i < steps.size(); ++i) {
    if (runs.empty() || !nearly(steps[i], runs.back().step)) {
      runs.push_back({i, 0, steps[i]});
    }
    ++runs.back().count;
  }
  return runs;
}

/// How many slices a short run lacks at each of its steps, 0 if it is none (see plan_stack).
long missing_per_step(const std::vector<Run>& runs, size_t i, double common) {
  const Run& run = runs[i];
  if (run.count > 2 || runs.size() == 1) {
    return 0;
  }
  const double before = i > 0 ? runs[i - 1].step : runs[i + 1].step;
  const double after = i + 1 < runs.size() ? runs[i + 1].step : before;
  const double multiple = std::round(run.step / before);
  const bool doubled =
      nearly(before, after) && multiple >= 2 && nearly(run.step, multiple * before);
  if (doubled) {
    return std::lround(multiple) - 1;
  }
  return run.step > 3.5 * common ? std::lround(run.step / common) - 1 : 0;
}

/// The steps that look like holes rather than like a change of spacing.
std::vector<StackGap> gaps_in(const std::vector<double>& steps) {
  const std::vector<Run> runs = runs_of(steps);
  const double common = most_common(steps);
  std::vector<StackGap> gaps;
  for (size_t i = 0; i < runs.size(); ++i) {
    const long lacking = missing_per_step(runs, i, common);
    for (size_t step = 0; lacking > 0 && step < runs[i].count; ++step) {
      constexpr long kUncountable = 1'000'000;  // a position far off: no count helps
      gaps.push_back({runs[i].first + step, static_cast<int>(std::min(lacking, kUncountable))});
    }
  }
  return gaps;
}

size_t missing_in(const std::vector<StackGap>& gaps) {
  size_t missing = 0;
  for (const StackGap& gap : gaps) {
    missing += static_cast<size_t>(gap.missing);
  }
  return missing;
}

void refuse_large_gaps(const std::vector<StackGap>& gaps, const std::vector<double>& steps,
                       Gaps policy, const std::string& where) {
  if (gaps.empty()) {
    return;
  }
  const size_t missing = missing_in(gaps);
  const size_t whole = steps.size() + 1 + missing;
  const int longest = std::ranges::max(gaps, {}, &StackGap::missing).missing;
  const bool few = longest <= kMostMissingInARow &&
                   static_cast<double>(missing) <= kMostMissingPart * static_cast<double>(whole);
  if (few && policy == Gaps::kInterpolate) {
    return;
  }
  const size_t first = gaps.front().after;
  throw Error(
      "{}: {} of {} slices missing, the first after slice {} ({:.2f} mm to the next, most are "
      "{:.2f} mm apart); copy the whole series{}",
      where, missing, whole, first + 1, steps[first], most_common(steps),
      few ? ", or leave --gaps refuse out to have them interpolated"
          : fmt::format(" (at most {} in a row and {:.0f} % of all are interpolated)",
                        kMostMissingInARow, 100 * kMostMissingPart));
}

/// The steps, gaps divided among the slices that they lack.
std::vector<double> with_gaps_filled(const std::vector<double>& steps,
                                     const std::vector<StackGap>& gaps) {
  std::vector<double> filled = steps;
  for (const StackGap& gap : gaps) {
    filled[gap.after] /= gap.missing + 1;
  }
  return filled;
}

/// The finest of the spacings that the scan kept for a while: a single odd step, where two blocks
/// of slices overlap, must not multiply the data.
double finest_lasting_step(const std::vector<double>& steps, double otherwise) {
  double finest = std::numeric_limits<double>::max();
  for (const Run& run : runs_of(steps)) {
    if (run.count >= 3) {
      finest = std::min(finest, run.step);
    }
  }
  return finest < std::numeric_limits<double>::max() ? finest : otherwise;
}

struct Spread {
  double median = 0;
  double smallest = 0;
  double largest = 0;
  bool uneven = false;
};

Spread spread_of(std::vector<double> steps) {
  std::ranges::sort(steps);
  const double median = steps[steps.size() / 2];
  const double tolerance = std::max(0.02 * median, 0.02);
  return {median, steps.front(), steps.back(),
          median - steps.front() > tolerance || steps.back() - median > tolerance};
}

}  // namespace

glm::dvec3 normal_of(const DicomHeader& slice) { return glm::cross(slice.row, slice.column); }

double along_normal(const DicomHeader& slice, const glm::dvec3& normal) {
  return glm::dot(slice.position, normal);
}

StackPlan plan_stack(const std::vector<DicomHeader>& slices, Gaps gaps, const std::string& where) {
  const glm::dvec3 normal = normal_of(slices.front());
  std::vector<double> steps;
  for (size_t i = 1; i < slices.size(); ++i) {
    steps.push_back(along_normal(slices[i], normal) - along_normal(slices[i - 1], normal));
  }

  StackPlan plan;
  if (spread_of(steps).uneven) {
    plan.gaps = gaps_in(steps);
    refuse_large_gaps(plan.gaps, steps, gaps, where);
  }
  const std::vector<double> filled = with_gaps_filled(steps, plan.gaps);
  const Spread spread = spread_of(filled);
  plan.smallest_step = spread.smallest;
  plan.largest_step = spread.largest;
  plan.uneven = spread.uneven;
  const glm::dvec3 whole = slices.back().position - slices.front().position;
  const double depth = glm::dot(whole, normal);
  plan.step = plan.uneven ? finest_lasting_step(filled, spread.median)
                          : depth / static_cast<double>(steps.size() + missing_in(plan.gaps));

  for (const DicomHeader& slice : slices) {
    const glm::dvec3 shift = slice.position - slices.front().position;
    const glm::dvec3 in_plane = shift - normal * glm::dot(shift, normal);
    plan.largest_shift = std::max(plan.largest_shift, glm::length(in_plane));
  }
  const DicomHeader& first = slices.front();
  plan.sheared = plan.largest_shift > 0.5 * std::min(first.pixel_spacing.x, first.pixel_spacing.y);
  plan.tilt_deg = glm::degrees(std::atan2(glm::length(whole - normal * depth), depth));
  return plan;
}

std::string describe_gaps(const StackPlan& plan, const std::vector<DicomHeader>& slices) {
  const glm::dvec3 normal = normal_of(slices.front());
  const size_t missing = missing_in(plan.gaps);
  std::string text = fmt::format("{} of {} slices {} missing:", missing, slices.size() + missing,
                                 missing == 1 ? "is" : "are");
  size_t filled = 0;  // by gaps before
  for (const StackGap& gap : plan.gaps) {
    const double below = along_normal(slices[gap.after], normal);
    const double step = (along_normal(slices[gap.after + 1], normal) - below) / (gap.missing + 1);
    const size_t first = gap.after + filled + 2;  // counted from 1, the one after `after`
    text += filled == 0 ? "" : ",";
    if (gap.missing == 1) {
      text += fmt::format(" slice {} (at {:.2f} mm)", first, below + step);
    } else {
      text += fmt::format(" slices {} to {} (at {:.2f} to {:.2f} mm)", first,
                          first + static_cast<size_t>(gap.missing) - 1, below + step,
                          below + gap.missing * step);
    }
    filled += static_cast<size_t>(gap.missing);
  }
  return text;
}

}  // namespace clipgs
