#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "section/section.h"

namespace clipgs {

/// Collects by how much values were missed, for bands of neighbouring codes: codes are close
/// together where values are common or seen, and there a value read back is worth more.
class ErrorBands {
 public:
  void add(float code, double error) {
    Band& band = bands_[Section::error_band(code)];
    band.squares += error * error;
    band.count += 1;
  }
  void add(const ErrorBands& other) {
    for (size_t i = 0; i < bands_.size(); ++i) {
      bands_[i].squares += other.bands_[i].squares;
      bands_[i].count += other.bands_[i].count;
    }
  }
  /// These errors on top of independent ones.
  std::array<float, Section::kErrorBands> on_top_of(
      const std::array<float, Section::kErrorBands>& before) const {
    std::array<float, Section::kErrorBands> rms{};
    for (size_t i = 0; i < bands_.size(); ++i) {
      const double square = bands_[i].count > 0 ? bands_[i].squares / bands_[i].count : 0;
      rms[i] = static_cast<float>(std::sqrt(square + std::pow(before[i], 2)));
    }
    return rms;
  }

 private:
  struct Band {
    double squares = 0;
    double count = 0;
  };
  std::array<Band, Section::kErrorBands> bands_{};
};

}  // namespace clipgs
