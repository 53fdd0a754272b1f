#include "archive/case_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

/// Asked by the leak sanitizer: fontconfig keeps what it read of fonts until the process ends.
extern "C" const char* __lsan_default_suppressions() { return "leak:libfontconfig"; }

namespace clipgs {
namespace {

using ::testing::HasSubstr;

CaseReport some_report() {
  CaseReport report;
  report.title = "Chest, lung";
  report.pictures = {Image(8, 8, 3), Image(8, 8, 3)};
  report.figures = {{"Slices", "234"}};
  report.notes = {"gantry tilted by 16 degrees, resampled"};
  report.link = "https://cases.example/it's/#case=chest%2Fa";
  return report;
}

TEST(CaseReport, IsAPdfWithALink) {
  const std::string pdf = report_pdf(some_report());
  EXPECT_EQ(pdf.substr(0, 5), "%PDF-");
  EXPECT_THAT(pdf, HasSubstr("/S /URI"));
  EXPECT_THAT(pdf, HasSubstr("https://cases.example/it's/#case=chest%2Fa"));
}

TEST(CaseReport, SameInputGivesTheSameBytes) {
  EXPECT_EQ(report_pdf(some_report()), report_pdf(some_report()));
}

TEST(CaseReport, StaysOnItsPage) {
  CaseReport report = some_report();
  report.notes.assign(200, "another warning: see the log");
  report.link.clear();
  const std::string pdf = report_pdf(report);
  EXPECT_THAT(pdf, HasSubstr("/Count 1"));
  EXPECT_THAT(pdf, ::testing::Not(HasSubstr("/URI")));
}

}  // namespace
}  // namespace clipgs
