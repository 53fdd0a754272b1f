#include "study/grim.h"

#include <cmath>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"

namespace clipgs {
namespace {

using testing::HasSubstr;

TEST(Grim, FindsThePapersMeansImpossible) {
  const GrimResult result = grim({"71.80", 10, "2.5"});
  EXPECT_FALSE(result.possible);
  EXPECT_EQ(result.below.sum, "717.5");
  EXPECT_EQ(result.below.mean, "71.75");
  EXPECT_EQ(result.above.sum, "720");
  EXPECT_EQ(result.above.mean, "72.00");
  EXPECT_FALSE(grim({"88.20", 10, "2.5"}).possible);
  EXPECT_TRUE(grim({"3.40", 10, "1"}).possible);
  EXPECT_TRUE(grim({"4.70", 10, "1"}).possible);
  EXPECT_THAT(grim_text({"71.80", 10, "2.5"}),
              HasSubstr("71.80 cannot come from 10 scores that are multiples of 2.5; the nearest "
                        "sums: 717.5 (mean 71.75) and 720 (mean 72.00)"));
}

TEST(Grim, TakesTheDigitsAsTheyArePrinted) {
  EXPECT_TRUE(grim({"71.8", 10, "2.5"}).possible);   // 71.75, half up
  EXPECT_FALSE(grim({"71.7", 10, "2.5"}).possible);  // by no rule
  EXPECT_TRUE(grim({"72", 10, "2.5"}).possible);
  EXPECT_TRUE(grim({"0.1", 10, "1"}).possible);
  EXPECT_FALSE(grim({"0.15", 10, "1"}).possible);
}

TEST(Grim, HalvesMayGoUpOrToEven) {
  EXPECT_TRUE(grim({"2", 2, "1"}).possible);
  EXPECT_TRUE(grim({"0.12", 8, "1"}).possible);  // .125 to even
  EXPECT_TRUE(grim({"0.13", 8, "1"}).possible);  // … and up
  EXPECT_TRUE(grim({"0.38", 8, "1"}).possible);  // .375 both ways
  EXPECT_FALSE(grim({"0.37", 8, "1"}).possible);
}

// Every mean of n scores passes when it is printed, and as many of the printable means as there are
// sums do.
TEST(Grim, AgreesWithAllSums) {
  for (int n = 3; n <= 37; ++n) {
    int possible = 0;
    for (int hundredths = 0; hundredths < 500; ++hundredths) {
      bool found = false;
      for (int sum = 0; sum <= 5 * n; ++sum) {
        // mean · 100 − hundredths within a half, in halves of 1 / n
        const int twice_off = 2 * (100 * sum - hundredths * n);
        found |= twice_off >= -n && (twice_off < n || (twice_off == n && hundredths % 2 == 0));
      }
      const GrimCheck check{fmt::format("{}.{:02}", hundredths / 100, hundredths % 100),
                            static_cast<size_t>(n), "1"};
      EXPECT_EQ(grim(check).possible, found) << check.mean << " of " << n;
      possible += found ? 1 : 0;
    }
    EXPECT_GE(possible, 5 * n - 1);
    EXPECT_LT(possible, 500);
  }
}

TEST(Grim, ManyScoresCanHaveAnyMean) {
  EXPECT_TRUE(grim({"71.80", 100000, "2.5"}).possible);
  EXPECT_TRUE(grim({"123.456789", 100000, "0.001"}).below.sum == "12345678.9");
}

TEST(Grim, ReadsAnArgument) {
  const GrimCheck check = parse_grim_check("71.80,10,2.5");
  EXPECT_EQ(check.mean, "71.80");
  EXPECT_EQ(check.n, 10);
  EXPECT_EQ(check.step, "2.5");
  for (const char* wrong : {"",
                            "71.80",
                            "71.80,10",
                            "71.80,,2.5",
                            ",10,2.5",
                            "71.80,10,",
                            "71.80,10,0",
                            "71.80,0,1",
                            "71.80,-3,1",
                            "-1,10,1",
                            "7a,10,1",
                            "1.2.3,10,1",
                            "71.80,10.5,1",
                            "71.80,10,2.5,1",
                            "71.80,1000000,1",
                            "0.1234567,10,1",
                            "1234567890,10,1",
                            "1,10,1001",
                            "1,10,0.0001",
                            ".,1,1",
                            "nan,10,1",
                            ",",
                            ",,"}) {
    EXPECT_THROW(parse_grim_check(wrong), Error) << wrong;
  }
}

}  // namespace
}  // namespace clipgs
