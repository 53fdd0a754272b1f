#include "archive/proxy.h"

#include <cstdlib>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "volume/test_folder.h"

namespace clipgs {
namespace {

using testing::HasSubstr;
using testing::Not;

/// The variables of an environment that has no other ones; unset in the end.
class Variables {
 public:
  Variables(std::initializer_list<std::pair<const char*, const char*>> all) {
    unset();
    for (const auto& [name, value] : all) {
      ::setenv(name, value, 1);
    }
  }
  ~Variables() { unset(); }
  Variables(const Variables&) = delete;
  Variables& operator=(const Variables&) = delete;

 private:
  static void unset() {
    for (const char* name : {"https_proxy", "HTTPS_PROXY", "http_proxy", "HTTP_PROXY", "all_proxy",
                             "ALL_PROXY", "no_proxy", "NO_PROXY"}) {
      ::unsetenv(name);
    }
  }
};

TEST(Proxy, IsTheEnvironments) {
  const Url secure = parse_url("https://pacs.example/rs");
  const Url open = parse_url("http://pacs.example/rs");
  {
    const Variables none({});
    EXPECT_FALSE(proxy_for(secure));
  }
  {
    const Variables both({{"https_proxy", "http://us%40er:se%3Acret@proxy.example:3128/"},
                          {"http_proxy", "10.0.0.7"}});
    const Proxy proxy = proxy_for(secure).value();
    EXPECT_EQ(proxy.host, "proxy.example");
    EXPECT_EQ(proxy.port, 3128);
    EXPECT_EQ(proxy.user, "us@er");
    EXPECT_EQ(proxy.password, "se:cret");
    EXPECT_EQ(proxy_for(open)->host, "10.0.0.7");
    EXPECT_EQ(proxy_for(open)->port, 1080);
  }
  {
    const Variables all({{"ALL_PROXY", "http://[fd00::7]:80"}, {"HTTP_PROXY", "http://evil:1"}});
    EXPECT_EQ(proxy_for(secure)->host, "fd00::7");
    EXPECT_EQ(proxy_for(open)->port, 80) << "HTTP_PROXY is a header of requests to web servers";
  }
  {
    const Variables exempt(
        {{"https_proxy", "http://proxy.example:3128"}, {"no_proxy", ".example"}});
    EXPECT_FALSE(proxy_for(secure));
  }
}

TEST(Proxy, WhatIsNoneIsRefusedAndNotRepeated) {
  for (const char* wrong :
       {"socks5://secret@proxy.example", "http://secret@pro xy", "secret@:80"}) {
    const Variables variables({{"https_proxy", wrong}});
    const std::string error = error_of([] { proxy_for(parse_url("https://pacs.example")); });
    EXPECT_THAT(error, HasSubstr("https_proxy")) << wrong;
    EXPECT_THAT(error, Not(HasSubstr("secret")));
  }
}

TEST(Proxy, HostsAreExemptByNamesAddressesAndNetworks) {
  for (const char* list : {"*", "pacs.example", "other, .example", "example", "a.b,pacs.example"}) {
    EXPECT_TRUE(is_exempt("pacs.example", list)) << list;
  }
  for (const char* list : {"", "acs.example", "pacs", "pacs.example.org", "10.0.0.0/8", ",,"}) {
    EXPECT_FALSE(is_exempt("pacs.example", list)) << list;
  }
  EXPECT_TRUE(is_exempt("10.1.2.3", "10.0.0.0/8"));
  EXPECT_TRUE(is_exempt("10.1.2.3", "10.1.2.2/31"));
  EXPECT_TRUE(is_exempt("fd00:1::7", "fd00:1::/32"));
  EXPECT_FALSE(is_exempt("11.1.2.3", "10.0.0.0/8"));
  EXPECT_FALSE(is_exempt("10.1.2.3", "10.0.0.0/33"));
  EXPECT_FALSE(is_exempt("10.1.2.3", "2.3"));
}

}  // namespace
}  // namespace clipgs
