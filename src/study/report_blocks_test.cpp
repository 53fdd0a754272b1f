#include "study/report_blocks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "study/study_report.h"

namespace clipgs {
namespace {

using testing::HasSubstr;
using testing::Not;

std::vector<ReportBlock> two_blocks() {
  return {{"Left out", {"participant 3: a_b | 50 % & {x}"}, {}, {}},
          {"", {}, {"measure", "d_z"}, {{"größer", "−1 ± 2"}, {"x", "[1, 2]"}}}};
}

TEST(ReportBlocks, TextIsAligned) {
  EXPECT_EQ(format_report(two_blocks(), ReportFormat::kText),
            "Left out\n  participant 3: a_b | 50 % & {x}\n\n"
            "  measure  d_z\n  ───────  ──────\n  größer   −1 ± 2\n  x        [1, 2]\n");
}

TEST(ReportBlocks, MarkdownIsNoMarkupOfTheText) {
  const std::string text = format_report(two_blocks(), ReportFormat::kMarkdown);
  EXPECT_THAT(text, HasSubstr("## Left out\n\n- participant 3: a\\_b \\| 50 % &amp; {x}\n"));
  EXPECT_THAT(text, HasSubstr("| measure | d\\_z |\n|---|---|\n| größer | −1 ± 2 |\n"));
}

TEST(ReportBlocks, LatexIsNoMarkupOfTheText) {
  const std::string text = format_report(two_blocks(), ReportFormat::kLatex);
  EXPECT_THAT(text, HasSubstr("\\item participant 3: a\\_b | 50 \\% \\& \\{x\\}\n"));
  EXPECT_THAT(text, HasSubstr("\\begin{tabular}{ll}\n  \\toprule\n  {}measure & $d_z$ \\\\\n"));
  EXPECT_THAT(format_report({{"--effect \\x", {}, {}, {}}}, ReportFormat::kLatex),
              HasSubstr("\\paragraph{-{}-effect \\textbackslash{}x}"));
  EXPECT_THAT(text, HasSubstr("$-$1 $\\pm$ 2 \\\\\n"));
  EXPECT_THAT(text, HasSubstr("\\bottomrule\n\\end{tabular}\n"));
}

TEST(ReportBlocks, KnowFormatsByName) {
  EXPECT_EQ(parse_report_format("text"), ReportFormat::kText);
  EXPECT_EQ(parse_report_format("latex"), ReportFormat::kLatex);
  EXPECT_THROW(parse_report_format("html"), Error);
}

TEST(StudyReport, PrintsNumbersAsPapersDo) {
  EXPECT_EQ(p_text(0.01526), "p = .015");
  EXPECT_EQ(p_text(0.0009), "p < .001");
  EXPECT_EQ(p_text(0.001), "p = .001");
  EXPECT_EQ(p_text(0.9996), "p > .999");
  EXPECT_EQ(p_text(1), "p > .999");
  EXPECT_EQ(p_text(0.9984), "p = .998");
  EXPECT_EQ(share_text(-0.727, 2), "−.73");
  EXPECT_EQ(share_text(1, 2), "1.00");
  EXPECT_EQ(share_text(-0.001, 2), ".00");
  EXPECT_EQ(signed_text(-2.9884, 3), "−2.988");
  EXPECT_EQ(signed_text(10.5, 1), "10.5");
  EXPECT_EQ(signed_text(-0.0001, 2), "0.00");
}

}  // namespace
}  // namespace clipgs
