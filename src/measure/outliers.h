#pragma once

#include <optional>
#include <span>
#include <vector>

namespace clipgs {

/// Among fewer values none stands out.
constexpr size_t kLeastForOutliers = 8;

/// How far values lie from the median of all, in robust standard deviations: 1.4826 times the
/// median of the absolute deviations, or, where half of the values are the same, 1.2533 times their
/// mean (Iglewicz and Hoaglin 1993), but at least `least`, a difference that nobody minds. Values
/// that are not there have none.
std::vector<std::optional<double>> robust_scores(std::span<const std::optional<double>> values,
                                                 double least);

/// Iglewicz and Hoaglin's: what lies further from the median stands out.
constexpr double kStandsOut = 3.5;

/// Of those that are there; nothing of none.
std::optional<double> median_of(std::span<const std::optional<double>> values);

}  // namespace clipgs
