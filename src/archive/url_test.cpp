#include "archive/url.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "volume/test_folder.h"

namespace clipgs {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Url, HasAPlaceAndAPath) {
  const Url url = parse_url("https://PACS.example:8443/dicom-web?x=1");
  EXPECT_TRUE(url.tls);
  EXPECT_EQ(url.host, "pacs.example");
  EXPECT_EQ(url.port, 8443);
  EXPECT_EQ(url.path, "/dicom-web?x=1");
  EXPECT_EQ(url.place(), "pacs.example:8443");
  EXPECT_EQ(parse_url("https://pacs.example").place(), "pacs.example");
  EXPECT_EQ(parse_url("http://[fd00::7]:8042/").place(), "[fd00::7]:8042");
  EXPECT_EQ(parse_url("http://a").port, 80);
}

TEST(Url, WhatIsNoneIsRefusedAndNotRepeated) {
  for (const char* wrong :
       {"", "pacs.example", "ftp://secret", "https://", "https:///secret", "https://secret:0",
        "https://secret:65536", "https://secret:8x", "https://a b/secret",
        "https://a/secret\r\nX: y", "https://[secret]", "https://[::1]secret",
        "https://user:secret@pacs.example/", "https://a/#secret"}) {
    const std::string error = error_of([&] { parse_url(wrong); });
    EXPECT_THAT(error, HasSubstr("the archive's address")) << wrong;
    EXPECT_THAT(error, Not(HasSubstr("secret"))) << wrong;
  }
}

TEST(Url, RedirectsLeadToAddressesOrPaths) {
  const Url from = parse_url("https://a.example:8443/x");
  EXPECT_TRUE(redirected(from, "/y?z").is_same_place(from));
  EXPECT_EQ(redirected(from, "/y?z").path, "/y?z");
  EXPECT_FALSE(redirected(from, "https://a.example/y").is_same_place(from)) << "another port";
  EXPECT_FALSE(redirected(from, "http://a.example:8443/y").is_same_place(from));
  EXPECT_NE(error_of([&] { redirected(from, "//b.example/y"); }), "");
  EXPECT_NE(error_of([&] { redirected(from, ""); }), "");
}

TEST(Url, ThisMachineIsKnown) {
  for (const char* here :
       {"http://localhost:1", "http://127.0.0.1", "http://127.9.9.9", "http://[::1]"}) {
    EXPECT_TRUE(is_this_machine(parse_url(here))) << here;
  }
  for (const char* elsewhere :
       {"http://localhost.example", "http://127.example", "http://10.0.0.1"}) {
    EXPECT_FALSE(is_this_machine(parse_url(elsewhere))) << elsewhere;
  }
}

}  // namespace
}  // namespace clipgs
