#include "study/comparison.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "study/study_csv.h"
#include "study/study_report.h"

namespace clipgs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

StudyTable committed(const char* name) {
  return read_study_csv(std::filesystem::path(CLIPGS_SOURCE_DIR) / "presets" / "study" / name);
}

StudyTable table_of(std::string_view text) { return parse_study_csv(text, "t.csv"); }

/// A column of whole values of both modes, a row each.
StudyTable pairs_of(const std::vector<std::pair<double, double>>& pairs) {
  std::string text = "participant,mode,x\n";
  for (size_t i = 0; i < pairs.size(); ++i) {
    text += fmt::format("{0},a,{1}\n{0},b,{2}\n", i + 1, pairs[i].first, pairs[i].second);
  }
  return table_of(text);
}

std::string report_of(const StudyComparison& comparison) {
  return format_report(study_report(comparison), ReportFormat::kText);
}

// ClipGS-VR (arXiv 2601.19310) prints these; every digit of them is held.
TEST(StudyPaper, TheStatisticsAreThoseThatThePaperPrints) {
  const StudyComparison comparison = compare_modes(committed("synthetic-paper.csv"));
  EXPECT_THAT(comparison.modes, ElementsAre("uniaxial", "arbitrary"));
  EXPECT_EQ(comparison.participants, 10);
  EXPECT_TRUE(comparison.exclusions.empty());
  ASSERT_EQ(comparison.measures.size(), 2);

  const MeasureComparison& sus = comparison.measures[0];
  ASSERT_EQ(sus.measure, "sus");
  ASSERT_EQ(sus.pairs.size(), 10);
  EXPECT_EQ(fmt::format("{:.2f} {:.2f}", sus.first->mean, *sus.first->sd), "71.80 14.41");
  EXPECT_EQ(fmt::format("{:.2f} {:.2f}", sus.second->mean, *sus.second->sd), "88.20 9.35");
  EXPECT_EQ(fmt::format("{:.0f} {:.3f} {:.3f}", sus.t->df, sus.t->t, sus.t->p), "9 -2.988 0.015");
  EXPECT_EQ(sus.suggested, PairedTest::kT);

  const MeasureComparison& efficiency = comparison.measures[1];
  ASSERT_EQ(efficiency.measure, "efficiency");
  ASSERT_EQ(efficiency.pairs.size(), 10);
  EXPECT_EQ(fmt::format("{:.2f} {:.2f}", efficiency.first->mean, *efficiency.first->sd),
            "3.40 0.70");
  EXPECT_EQ(fmt::format("{:.2f} {:.2f}", efficiency.second->mean, *efficiency.second->sd),
            "4.70 0.48");
  EXPECT_EQ(fmt::format("{:.0f} {:.3f} {:.3f}", efficiency.wilcoxon->w, efficiency.wilcoxon->z,
                        efficiency.wilcoxon->p),
            "0 -2.739 0.006");
  EXPECT_EQ(efficiency.wilcoxon->zeros, 1);
  EXPECT_EQ(efficiency.wilcoxon->exact_p, 2.0 / 512);
  EXPECT_EQ(efficiency.wilcoxon->r, -1);
  EXPECT_EQ(efficiency.suggested, PairedTest::kWilcoxon);

  EXPECT_NEAR(efficiency.holm_p.value(), 4.0 / 512, 1e-15);
  EXPECT_EQ(sus.holm_p, sus.t->p);
}

TEST(StudyPaper, TheReportHasThePapersTexts) {
  const std::string report = report_of(compare_modes(committed("synthetic-paper.csv")));
  for (const char* text : {"71.80 ± 14.41", "88.20 ± 9.35", "t(9) = −2.988, p = .015 *",
                           "3.40 ± 0.70", "4.70 ± 0.48", "W = 0, Z = −2.739, p = .006 *",
                           "good; grade C+", "excellent; grade A+", "−0.94 [−1.68, −0.17]"}) {
    EXPECT_THAT(report, HasSubstr(text));
  }
}

TEST(StudyPaper, TenQuestionnairesComeAsNearAsTheFileSays) {
  const StudyTable table = committed("synthetic-items.csv");
  for (const StudyRow& row : table.rows) {
    EXPECT_EQ(row.answers.at("sus").size(), 10);
  }
  const StudyComparison comparison = compare_modes(table);
  const MeasureComparison& sus = comparison.measures.at(0);
  ASSERT_EQ(sus.pairs.size(), 10);
  EXPECT_EQ(fmt::format("{:.2f} {:.2f}", sus.first->mean, *sus.first->sd), "71.75 14.39");
  EXPECT_EQ(fmt::format("{:.2f} {:.2f}", sus.second->mean, *sus.second->sd), "88.25 9.36");
  EXPECT_EQ(fmt::format("{:.3f} {:.3f}", sus.t->t, sus.t->p), "-2.990 0.015");
  EXPECT_EQ(fmt::format("{:.3f}", comparison.measures.at(1).wilcoxon->z), "-2.739");
}

TEST(StudyComparison, TheOrderOfRowsDoesNotMatter) {
  StudyTable table = committed("synthetic-paper.csv");
  const std::string before = study_json(compare_modes(table));
  std::ranges::reverse(table.rows);
  std::ranges::rotate(table.rows, table.rows.begin() + 7);
  EXPECT_EQ(study_json(compare_modes(table)), before);
}

TEST(StudyComparison, SwappedModesFlipTheSigns) {
  const StudyTable table = committed("synthetic-paper.csv");
  const StudyComparison before = compare_modes(table);
  ComparisonOptions options;
  options.modes = {"arbitrary", "uniaxial"};
  const StudyComparison after = compare_modes(table, options);
  for (size_t i = 0; i < 2; ++i) {
    const MeasureComparison& a = before.measures[i];
    const MeasureComparison& b = after.measures[i];
    EXPECT_NEAR(b.t->t, -a.t->t, 1e-12);
    EXPECT_NEAR(b.t->dz, -a.t->dz, 1e-12);
    EXPECT_EQ(b.wilcoxon->r, -a.wilcoxon->r);
    EXPECT_EQ(b.wilcoxon->z, a.wilcoxon->z);
    EXPECT_NEAR(b.p.value(), a.p.value(), 1e-12);
    EXPECT_EQ(b.suggested, a.suggested);
    EXPECT_EQ(b.first->mean, a.second->mean);
  }
}

TEST(StudyComparison, SaysWhoIsLeftOut) {
  const StudyComparison comparison = compare_modes(
      table_of("participant,mode,sus,efficiency\n"
               "1,a,50,3\n1,b,60,4\n2,a,50,\n2,b,65,4\n3,a,55,2\n10,b,60,4\n4,a,40,3\n4,b,45,5\n"
               "5,a,70,4\n5,b,90,5\n"));
  ASSERT_EQ(comparison.exclusions.size(), 3);
  EXPECT_EQ(comparison.exclusions[0].participant, "3");
  EXPECT_EQ(comparison.exclusions[0].reason, "has no row in mode b");
  EXPECT_EQ(comparison.exclusions[1].participant, "10");
  EXPECT_EQ(comparison.exclusions[1].reason, "has no row in mode a");
  EXPECT_EQ(comparison.exclusions[2].participant, "2");
  EXPECT_EQ(comparison.exclusions[2].measure, "efficiency");
  EXPECT_EQ(comparison.measures[0].pairs.size(), 4);
  EXPECT_EQ(comparison.measures[1].pairs.size(), 3);
  const std::string report = report_of(comparison);
  EXPECT_THAT(report, HasSubstr("participant 3, everything: has no row in mode b"));
  EXPECT_THAT(report, HasSubstr("participant 2, Efficiency: no value at t.csv:4"));
}

TEST(StudyComparison, MoreModesThanTwoWantAChoice) {
  const StudyTable table = table_of("participant,mode,x\n1,a,1\n1,b,2\n1,c,3\n2,c,4\n");
  try {
    compare_modes(table);
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("a, b, c; choose two with --modes A,B"));
  }
  ComparisonOptions options;
  options.modes = {"c", "a"};
  const StudyComparison comparison = compare_modes(table, options);
  ASSERT_EQ(comparison.measures[0].pairs.size(), 1);
  EXPECT_EQ(comparison.measures[0].difference->mean, 2);
  EXPECT_EQ(comparison.exclusions.size(), 1);
  for (const auto& modes : {std::array<std::string, 2>{"a", "d"}, {"a", "a"}}) {
    options.modes = modes;
    EXPECT_THROW(compare_modes(table, options), Error);
  }
  EXPECT_THROW(compare_modes(table_of("participant,mode,x\n1,a,1\n")), Error);
}

TEST(StudyComparison, TwoPairsAreDescribedButNotTested) {
  const StudyComparison comparison = compare_modes(pairs_of({{1, 2}, {3, 5}}));
  const MeasureComparison& measure = comparison.measures[0];
  EXPECT_EQ(measure.first->mean, 2);
  EXPECT_EQ(measure.difference->mean, -1.5);
  EXPECT_FALSE(measure.t || measure.wilcoxon || measure.p || measure.holm_p || measure.sizes);
  EXPECT_EQ(measure.note, "no test: 2 pairs, and at least 3 are needed");
  EXPECT_THAT(report_of(comparison), HasSubstr("x: no test: 2 pairs, and at least 3 are needed"));
}

TEST(StudyComparison, DifferencesOfNothingAreNotTested) {
  const StudyComparison comparison = compare_modes(pairs_of({{1, 1}, {3, 3}, {4, 4}, {2, 2}}));
  EXPECT_EQ(comparison.measures[0].note, "no test: all differences are 0");
  EXPECT_EQ(comparison.measures[0].suggested, PairedTest::kNone);
  EXPECT_THAT(report_of(comparison), HasSubstr("x: no test: all differences are 0"));
}

TEST(StudyComparison, EqualDifferencesHaveRanksAlone) {
  const StudyComparison comparison =
      compare_modes(pairs_of({{1, 2}, {3, 4}, {4, 5}, {2, 3}, {7, 8}}));
  EXPECT_EQ(comparison.measures[0].note, "no t-test: all differences are equal");
  EXPECT_EQ(comparison.measures[0].suggested, PairedTest::kWilcoxon);
  EXPECT_EQ(comparison.measures[0].p, 2.0 / 32);
}

TEST(StudyComparison, HugeEffectsAreReported) {
  for (const double size : {1e3, 1e6, 1e11}) {
    const StudyComparison comparison = compare_modes(pairs_of(
        {{size, 0}, {size + 1, 0}, {size + 2, 0}, {size, 0.5}, {size + 1, 0.25}, {size - 1, 0}}));
    const MeasureComparison& measure = comparison.measures[0];
    ASSERT_TRUE(measure.t && measure.sizes) << size;
    EXPECT_LT(measure.t->p, 1e-6);
    EXPECT_EQ(measure.sizes->t, 2);
    EXPECT_FALSE(report_of(comparison).empty());
  }
}

TEST(StudyComparison, DecimalsTieWhereTheyDoOnPaper) {
  // 0.3 − 0.1 and 0.5 − 0.3 are no equal doubles, nor is 0.3 − 0.1 − 0.2 zero.
  const StudyComparison comparison =
      compare_modes(pairs_of({{0.3, 0.1}, {0.5, 0.3}, {0.7, 0.5}, {0.1, 0.1}, {1.1, 0.9}}));
  const Wilcoxon& test = *comparison.measures[0].wilcoxon;
  EXPECT_EQ(test.zeros, 1);
  EXPECT_EQ(test.exact_p, 2.0 / 16);
  EXPECT_NEAR(test.z, -2, 1e-12);  // all four tie: (0 − 5) / √(7.5 − 1.25)
}

TEST(StudyComparison, PlansForAnEffect) {
  ComparisonOptions options;
  options.effect = 0.5;
  const StudyComparison comparison = compare_modes(committed("synthetic-paper.csv"), options);
  ASSERT_TRUE(comparison.sizes);
  EXPECT_EQ(comparison.sizes->t, 34);
  EXPECT_EQ(comparison.sizes->wilcoxon, 36);
  EXPECT_THAT(report_of(comparison),
              HasSubstr("planned, d_z = 0.50: 34 by the paired t-test, 36 by Wilcoxon's"));
  options.effect = 0.001;
  EXPECT_FALSE(compare_modes(committed("synthetic-paper.csv"), options).sizes);
  options.target.power = 0.01;
  EXPECT_THROW(compare_modes(committed("synthetic-paper.csv"), options), Error);
}

TEST(StudyComparison, JsonHasAllDigits) {
  const StudyComparison comparison = compare_modes(committed("synthetic-paper.csv"));
  const auto json = nlohmann::json::parse(study_json(comparison));
  EXPECT_EQ(json["measures"][0]["t"]["t"].get<double>(), comparison.measures[0].t->t);
  EXPECT_EQ(json["measures"][0]["suggested"], "t");
  EXPECT_EQ(json["measures"][1]["suggested"], "wilcoxon");
  EXPECT_EQ(json["measures"][0]["pairs"].size(), 10);
  EXPECT_EQ(json["planned"], nullptr);
}

}  // namespace
}  // namespace clipgs
