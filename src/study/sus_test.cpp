#include "study/sus.h"

#include <array>
#include <gtest/gtest.h>
#include <vector>

#include "core/error.h"

namespace clipgs {
namespace {

TEST(Sus, ScoresAsBrookeDoes) {
  EXPECT_EQ(sus_score(std::array{5, 1, 5, 1, 5, 1, 5, 1, 5, 1}), 100);
  EXPECT_EQ(sus_score(std::array{1, 5, 1, 5, 1, 5, 1, 5, 1, 5}), 0);
  EXPECT_EQ(sus_score(std::array{3, 3, 3, 3, 3, 3, 3, 3, 3, 3}), 50);
  EXPECT_EQ(sus_score(std::array{4, 2, 4, 1, 5, 2, 4, 2, 4, 3}), 77.5);
}

TEST(Sus, EveryAnswerCountsTwoAndAHalf) {
  std::array<int, kSusItems> answers;
  answers.fill(3);
  for (size_t i = 0; i < answers.size(); ++i) {
    ++answers[i];
    EXPECT_EQ(sus_score(answers), i % 2 == 0 ? 52.5 : 47.5) << i;
    --answers[i];
  }
}

TEST(Sus, RefusesWhatIsNoQuestionnaire) {
  EXPECT_THROW(sus_score(std::array{3, 3, 3}), Error);
  std::array<int, kSusItems> answers;
  answers.fill(3);
  for (const int wrong : {0, 6, -1}) {
    answers[4] = wrong;
    EXPECT_THROW(sus_score(answers), Error) << wrong;
  }
}

TEST(Sus, AdjectivesBeginAtTheirMeans) {
  EXPECT_EQ(sus_adjective(100), "best imaginable");
  EXPECT_EQ(sus_adjective(88.2), "excellent");
  EXPECT_EQ(sus_adjective(85.5), "excellent");
  EXPECT_EQ(sus_adjective(85.4), "good");
  EXPECT_EQ(sus_adjective(71.8), "good");
  EXPECT_EQ(sus_adjective(71.3), "OK");
  EXPECT_EQ(sus_adjective(36), "poor");
  EXPECT_EQ(sus_adjective(21), "awful");
  EXPECT_EQ(sus_adjective(0), "worst imaginable");
  EXPECT_THROW(sus_adjective(100.1), Error);
}

TEST(Sus, GradesAreCurved) {
  EXPECT_EQ(sus_grade(88.2).letter, "A+");
  EXPECT_EQ(sus_grade(88.2).low, 96);
  EXPECT_EQ(sus_grade(84.0).letter, "A");
  EXPECT_EQ(sus_grade(71.8).letter, "C+");
  EXPECT_EQ(sus_grade(68).letter, "C");
  EXPECT_EQ(sus_grade(68).low, 41);
  EXPECT_EQ(sus_grade(68).high, 59);
  EXPECT_EQ(sus_grade(51.6).letter, "F");
  EXPECT_THROW(sus_grade(-1), Error);
}

TEST(Sus, BetterScoresAreNeverGradedWorse) {
  int low = 0;
  for (int tenths = 0; tenths <= 1000; ++tenths) {
    const SusGrade grade = sus_grade(tenths / 10.0);
    EXPECT_GE(grade.low, low) << tenths;
    EXPECT_GT(grade.high, grade.low) << tenths;
    low = grade.low;
  }
  EXPECT_EQ(low, 96);
}

TEST(Tlx, IsTheMeanOfSixScales) {
  EXPECT_EQ(raw_tlx(std::vector<double>{0, 20, 40, 60, 80, 100}), 50);
  EXPECT_EQ(raw_tlx(std::vector<double>{5, 5, 5, 5, 5, 35}), 10);
  EXPECT_THROW(raw_tlx(std::vector<double>{0, 20, 40}), Error);
  EXPECT_THROW(raw_tlx(std::vector<double>{0, 20, 40, 60, 80, 101}), Error);
}

}  // namespace
}  // namespace clipgs
