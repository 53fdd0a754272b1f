#include "core/percent.h"

#include <gtest/gtest.h>

namespace clipgs {
namespace {

TEST(Percent, AddressesAreEncoded) {
  EXPECT_EQ(percent_encode("head 1/2?"), "head%201%2F2%3F");
  EXPECT_EQ(percent_encode("Schädel"), "Sch%C3%A4del");
  EXPECT_EQ(percent_decode("head%201%2f2%3F"), "head 1/2?");
  EXPECT_EQ(percent_decode("%00"), std::string(1, '\0'));
  for (const char* wrong : {"%", "%4", "a%g0", "%0g"}) {
    EXPECT_FALSE(percent_decode(wrong)) << wrong;
  }
}

}  // namespace
}  // namespace clipgs
