#include "core/utf8.h"

#include <gtest/gtest.h>

namespace clipgs {
namespace {

TEST(Utf8, WholeCharactersAreToldFromPieces) {
  for (const char* const text : {"", "Kopf", "Schädel", "頭部", "רֹאשׁ", "🫀"}) {
    EXPECT_TRUE(is_utf8(text)) << text;
  }
  for (const char* const text : {"\xFC", "M\xFCller", "\xED\xA0\x80", "a\xC3", "\xC0\x80"}) {
    EXPECT_FALSE(is_utf8(text)) << text;
  }
}

TEST(Utf8, BeginningsEndAfterAWholeCharacter) {
  EXPECT_EQ(utf8_beginning("頭部", 6), "頭部");
  EXPECT_EQ(utf8_beginning("頭部", 5), "頭");
  EXPECT_EQ(utf8_beginning("頭部", 2), "");
  EXPECT_EQ(utf8_beginning("Kopf", 3), "Kop");
}

}  // namespace
}  // namespace clipgs
