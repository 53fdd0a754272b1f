#include "study/sus.h"

#include <array>
#include <numeric>

#include "core/error.h"

namespace clipgs {

namespace {

struct AdjectiveCut {
  double from;
  std::string_view adjective;
};
constexpr std::array kAdjectives{AdjectiveCut{90.9, "best imaginable"},
                                 AdjectiveCut{85.5, "excellent"},
                                 AdjectiveCut{71.4, "good"},
                                 AdjectiveCut{50.9, "OK"},
                                 AdjectiveCut{35.7, "poor"},
                                 AdjectiveCut{20.3, "awful"},
                                 AdjectiveCut{0, "worst imaginable"}};

struct GradeCut {
  double from;
  SusGrade grade;
};
constexpr std::array kGrades{
    GradeCut{84.1, {"A+", 96, 100}}, GradeCut{80.8, {"A", 90, 95}}, GradeCut{78.9, {"A−", 85, 89}},
    GradeCut{77.2, {"B+", 80, 84}},  GradeCut{74.1, {"B", 70, 79}}, GradeCut{72.6, {"B−", 65, 69}},
    GradeCut{71.1, {"C+", 60, 64}},  GradeCut{65.0, {"C", 41, 59}}, GradeCut{62.7, {"C−", 35, 40}},
    GradeCut{51.7, {"D", 15, 34}},   GradeCut{0, {"F", 0, 14}}};

void require_sus_score(double score) {
  if (!(score >= 0 && score <= 100)) {
    throw Error("a SUS score of {} does not lie in 0 to 100; check the answers", score);
  }
}

}  // namespace

double sus_score(std::span<const int> answers) {
  if (answers.size() != kSusItems) {
    throw Error("SUS: {} answers, but it has {} items; score complete questionnaires alone",
                answers.size(), kSusItems);
  }
  int sum = 0;
  for (size_t i = 0; i < kSusItems; ++i) {
    if (answers[i] < 1 || answers[i] > 5) {
      throw Error("SUS: the answer {} to item {} does not lie in 1 to 5; check the data",
                  answers[i], i + 1);
    }
    const bool odd_item = i % 2 == 0;
    sum += odd_item ? answers[i] - 1 : 5 - answers[i];
  }
  return sum * 2.5;
}

std::string_view sus_adjective(double score) {
  require_sus_score(score);
  size_t i = 0;
  while (score < kAdjectives[i].from) {
    ++i;
  }
  return kAdjectives[i].adjective;
}

SusGrade sus_grade(double score) {
  require_sus_score(score);
  size_t i = 0;
  while (score < kGrades[i].from) {
    ++i;
  }
  return kGrades[i].grade;
}

double raw_tlx(std::span<const double> scales) {
  if (scales.size() != kTlxScales) {
    throw Error("NASA-TLX: {} scales, but it has {}; take complete questionnaires alone",
                scales.size(), kTlxScales);
  }
  for (const double scale : scales) {
    if (!(scale >= 0 && scale <= 100)) {
      throw Error("NASA-TLX: {} does not lie in 0 to 100; check the data", scale);
    }
  }
  return std::accumulate(scales.begin(), scales.end(), 0.0) / kTlxScales;
}

}  // namespace clipgs
