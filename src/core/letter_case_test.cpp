#include "core/letter_case.h"

#include <gtest/gtest.h>

namespace clipgs {
namespace {

TEST(LetterCase, OnlyLettersOfAsciiAreMadeSmall) {
  EXPECT_EQ(lower_case("Content-TYPE [@`{] Ä\xC4"), "content-type [@`{] Ä\xC4");
}

TEST(LetterCase, AlikeIsWhatDiffersInCaseAlone) {
  EXPECT_TRUE(is_alike("gzip", "GZip"));
  EXPECT_FALSE(is_alike("gzip", "gzip "));
  EXPECT_FALSE(is_alike("ä", "Ä"));
}

}  // namespace
}  // namespace clipgs
