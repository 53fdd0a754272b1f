#include "serve/client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"

namespace clipgs {
namespace {

using boost::asio::ip::make_address;

HttpRequest asking(const std::vector<std::pair<std::string, std::string>>& headers) {
  HttpRequest request;
  for (const auto& [name, value] : headers) {
    request.insert(name, value);
  }
  return request;
}

std::string client_behind(const TrustedProxies& proxies, const std::string& peer,
                          const std::vector<std::pair<std::string, std::string>>& headers) {
  return proxies.client(make_address(peer), asking(headers)).address;
}

TEST(Client, IsTheLastWhomNoTrustedProxyIs) {
  const TrustedProxies proxies({"127.0.0.1", "10.1.0.0/16", "fd00::/8"});
  const auto forwarded = [&](const std::string& value) {
    return client_behind(proxies, "127.0.0.1", {{"X-Forwarded-For", value}});
  };
  EXPECT_EQ(forwarded("192.0.2.7"), "192.0.2.7");
  EXPECT_EQ(forwarded("6.6.6.6, 192.0.2.7"), "192.0.2.7") << "what a client writes stands before";
  EXPECT_EQ(forwarded("192.0.2.7, 10.1.255.4"), "192.0.2.7") << "two proxies";
  EXPECT_EQ(forwarded("192.0.2.7, 10.2.0.4"), "10.2.0.4") << "another network";
  EXPECT_EQ(forwarded("2001:db8::7,fd00:1::2"), "2001:db8::7");
  EXPECT_EQ(forwarded("[2001:db8::7]:4711"), "2001:db8::7");
  EXPECT_EQ(forwarded("192.0.2.7:4711"), "192.0.2.7");
  EXPECT_EQ(forwarded("::ffff:192.0.2.7"), "192.0.2.7");
  EXPECT_EQ(client_behind(proxies, "::ffff:127.0.0.1", {{"X-Forwarded-For", "192.0.2.7"}}),
            "192.0.2.7");
  EXPECT_EQ(client_behind(proxies, "127.0.0.1",
                          {{"X-Forwarded-For", "6.6.6.6"}, {"X-Forwarded-For", "192.0.2.7"}}),
            "192.0.2.7")
      << "headers of one name are one list";
}

TEST(Client, IsWhoConnectsWhereNobodyIsTrusted) {
  const TrustedProxies nobody;
  const TrustedProxies proxies({"10.1.0.1"});
  const std::vector<std::pair<std::string, std::string>> spoofed = {{"X-Forwarded-For", "6.6.6.6"},
                                                                    {"Forwarded", "for=6.6.6.6"}};
  EXPECT_EQ(client_behind(nobody, "127.0.0.1", spoofed), "127.0.0.1");
  EXPECT_EQ(client_behind(proxies, "192.0.2.7", spoofed), "192.0.2.7");
  for (const char* nonsense : {"", "unknown", "_hidden", "192.0.2", "1.2.3.4.5", "[", "[::1", "\"",
                               "x\ny", "192.0.2.7,,"}) {
    EXPECT_EQ(client_behind(proxies, "10.1.0.1", {{"X-Forwarded-For", nonsense}}), "10.1.0.1")
        << nonsense;
  }
}

TEST(Client, IsToldByForwardedWhereThereIsNothingElse) {
  const TrustedProxies proxies({"10.1.0.1"});
  const auto forwarded = [&](const std::string& value) {
    return client_behind(proxies, "10.1.0.1", {{"Forwarded", value}});
  };
  EXPECT_EQ(forwarded("for=6.6.6.6, proto=https;For=\"[2001:db8::7]:80\";by=10.1.0.1"),
            "2001:db8::7");
  EXPECT_EQ(forwarded("by=192.0.2.7"), "10.1.0.1");
  EXPECT_EQ(client_behind(proxies, "10.1.0.1",
                          {{"Forwarded", "for=6.6.6.6"}, {"X-Forwarded-For", "192.0.2.7"}}),
            "192.0.2.7")
      << "proxies that write the one hand on the other as clients wrote it";
}

TEST(Client, IsThisMachineOnlyWhereNoProxyIs) {
  const TrustedProxies nobody;
  const TrustedProxies proxies({"127.0.0.1"});
  EXPECT_TRUE(nobody.client(make_address("127.0.0.1"), asking({})).is_local);
  EXPECT_TRUE(nobody.client(make_address("::1"), asking({})).is_local);
  EXPECT_FALSE(nobody.client(make_address("192.0.2.7"), asking({})).is_local);
  EXPECT_FALSE(proxies.client(make_address("127.0.0.1"), asking({})).is_local);
  EXPECT_FALSE(
      nobody.client(make_address("127.0.0.1"), asking({{"X-Forwarded-For", "::1"}})).is_local);
}

TEST(Client, OfAnIPv6NetworkIsOne) {
  EXPECT_EQ(network_of(make_address("2001:db8:1:2:3::4")), "2001:db8:1:2::");
  EXPECT_EQ(network_of(make_address("::ffff:192.0.2.7")), "192.0.2.7");
}

TEST(Client, ProxiesAreAddresses) {
  for (const char* wrong : {"", "proxy", "10.1.0.0/33", "10.1.0.0/-1", "10.1.0.0/8x", "10.1.0.0/",
                            "::/129", "1.2.3.4:80"}) {
    EXPECT_THROW(TrustedProxies({wrong}), Error) << wrong;
  }
  EXPECT_EQ(client_behind(TrustedProxies({"0.0.0.0/0"}), "192.0.2.7",
                          {{"X-Forwarded-For", "2001:db8::7"}}),
            "2001:db8::7");
}

}  // namespace
}  // namespace clipgs
