#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace clipgs {

inline constexpr size_t kSusItems = 10;
inline constexpr size_t kTlxScales = 6;

/// Score of one System Usability Scale (Brooke 1996), 0…100 in steps of 2.5: the sum of answer − 1
/// of the odd items and 5 − answer of the even ones, times 2.5. `answers` are those to items 1…10,
/// each 1 (strongly disagree) … 5 (strongly agree). Throws Error for another number of answers or
/// one out of range.
double sus_score(std::span<const int> answers);

/// The adjective of a score (0…100) or of a mean of scores: the best one whose mean score it
/// reaches. Cut points are the mean scores that Bangor, Kortum & Miller (Journal of Usability
/// Studies 4(3), 2009, table 3) found for each adjective: 12.5 worst imaginable, 20.3 awful, 35.7
/// poor, 50.9 OK, 71.4 good, 85.5 excellent, 90.9 best imaginable; what lies below all of them is
/// "worst imaginable", too. Throws Error for a score out of range.
std::string_view sus_adjective(double score);

/// A grade, and the percentiles of studies that it stands for.
struct SusGrade {
  std::string_view letter;  ///< A+ … F
  int low = 0;              ///< percentile, 0…100
  int high = 0;
};

/// Grade of a mean SUS score on the curved scale of Sauro & Lewis (Quantifying the User Experience,
/// 2nd ed. 2016, table 8.5), made of 446 studies: A+ from 84.1, A 80.8, A− 78.9, B+ 77.2, B 74.1,
/// B− 72.6, C+ 71.1, C 65, C− 62.7, D 51.7, F below. Throws Error for a score out of range.
SusGrade sus_grade(double score);

/// Raw NASA-TLX (Hart 2006): the mean of six scales, each 0…100, no weights. Throws Error for
/// another number of scales or one out of range.
double raw_tlx(std::span<const double> scales);

}  // namespace clipgs
