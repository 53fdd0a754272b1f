#pragma once

#include <cstddef>
#include <string>

namespace clipgs {

/// A mean as a paper prints it, and what it is said to be the mean of.
struct GrimCheck {
  std::string mean;  ///< decimal text: its digits say how it was rounded, e.g. "71.80"
  size_t n = 0;      ///< scores
  std::string step;  ///< what every score is a multiple of, e.g. "2.5" (SUS) or "1" (an item)
};

/// A sum that scores can have, and their mean with the digits of the printed one.
struct GrimSum {
  std::string sum;
  std::string mean;
};

/// Whether the mean can be true, and the nearest sums that there are around it.
struct GrimResult {
  bool possible = false;
  GrimSum below;  ///< … or equal
  GrimSum above;
};

/// "MEAN,N,STEP". Throws Error for what is no number (up to 9 digits, at most 6 after the point;
/// the step up to 3), for N out of 1…100000 and a step out of 0.001…1000.
GrimCheck parse_grim_check(const std::string& text);

/// The GRIM test (Brown & Heathers 2017): whether any sum of n multiples of the step gives the
/// printed mean when it is rounded, by either rule for halves (up, or to even). In whole numbers
/// throughout. Throws Error as parse_grim_check().
GrimResult grim(const GrimCheck& check);

/// One line for a person.
std::string grim_text(const GrimCheck& check);

}  // namespace clipgs
