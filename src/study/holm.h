#pragma once

#include <span>
#include <vector>

namespace clipgs {

/// p-values corrected for their number (Holm 1979), in the order given: the k-th smallest of m
/// times m − k + 1, never below one that was smaller, at most 1. Throws Error for a p out of 0…1.
std::vector<double> holm(std::span<const double> p);

}  // namespace clipgs
