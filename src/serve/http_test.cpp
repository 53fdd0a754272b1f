#include "serve/http.h"

#include <gtest/gtest.h>

namespace clipgs {
namespace {

using Ranges = std::vector<ByteRange>;

TEST(Http, RangesAreClampedToTheFile) {
  EXPECT_EQ(satisfiable_range({{0, 99}}, 1000), ByteRange(0, 99));
  EXPECT_EQ(satisfiable_range({{990, 5000}}, 1000), ByteRange(990, 999));
  EXPECT_EQ(satisfiable_range({{990, -1}}, 1000), ByteRange(990, 999));
  EXPECT_EQ(satisfiable_range({{-1, 10}}, 1000), ByteRange(990, 999));
  EXPECT_EQ(satisfiable_range({{-1, 5000}}, 1000), ByteRange(0, 999));
}

TEST(Http, RangesOutsideTheFileAreRefused) {
  EXPECT_FALSE(satisfiable_range({{1000, -1}}, 1000));
  EXPECT_FALSE(satisfiable_range({{1000, 2000}}, 1000));
  EXPECT_FALSE(satisfiable_range({{5, 4}}, 1000));
  EXPECT_FALSE(satisfiable_range({{-1, 0}}, 1000));
  EXPECT_FALSE(satisfiable_range({{0, 0}}, 0));
  EXPECT_FALSE(satisfiable_range({{0, 1}, {4, 5}}, 1000));
}

TEST(Http, EtagsMatchWhateverTheListLooksLike) {
  EXPECT_TRUE(etag_matches("\"a\"", "\"a\""));
  EXPECT_TRUE(etag_matches("\"b\", W/\"a\"", "\"a\""));
  EXPECT_TRUE(etag_matches("*", "\"a\""));
  EXPECT_FALSE(etag_matches("\"ab\"", "\"a\""));
  EXPECT_FALSE(etag_matches("", "\"a\""));
}

TEST(Http, HostNamesLoseTheirPort) {
  EXPECT_EQ(host_name("localhost:8080"), "localhost");
  EXPECT_EQ(host_name("[::1]:8080"), "::1");
  EXPECT_EQ(host_name("127.0.0.1"), "127.0.0.1");
  EXPECT_TRUE(is_loopback(host_name("127.0.0.1:1")));
  EXPECT_FALSE(is_loopback(host_name("localhost.example.org")));
  EXPECT_FALSE(is_loopback(host_name("")));
}

TEST(Http, AddressesAreEncoded) {
  EXPECT_EQ(percent_encode("head 1/2?"), "head%201%2F2%3F");
  EXPECT_EQ(percent_encode("Schädel"), "Sch%C3%A4del");
}

}  // namespace
}  // namespace clipgs
