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

TEST(Http, RangesAreParsed) {
  EXPECT_EQ(parse_ranges("bytes=0-99"), (Ranges{{0, 99}}));
  EXPECT_EQ(parse_ranges("Bytes=5- , -7"), (Ranges{{5, -1}, {-1, 7}}));
  for (const char* none : {"", "bytes", "bytes=", "lines=0-1", "bytes=-", "bytes=a-b", "bytes=5",
                           "bytes=9-5", "bytes=--5", "bytes=0-1-2", "bytes=0-1,,2-3",
                           "bytes=99999999999999999999-", "bytes=0x1-2", "bytes=+1-2"}) {
    EXPECT_TRUE(parse_ranges(none).empty()) << none;
  }
}

TEST(Http, TheEncodingThatIsLikedBestIsChosen) {
  const std::vector<Encoding> both = {Encoding::kGzip, Encoding::kBrotli};
  const auto choose = [&](const char* header) { return choose_encoding(header, both); };
  EXPECT_EQ(choose("gzip, deflate, br, zstd"), Encoding::kBrotli);
  EXPECT_EQ(choose("gzip, deflate"), Encoding::kGzip);
  EXPECT_EQ(choose("GZIP"), Encoding::kGzip);
  EXPECT_EQ(choose(""), Encoding::kIdentity);
  EXPECT_EQ(choose("identity"), Encoding::kIdentity);
  EXPECT_EQ(choose("br;q=0.5, gzip;q=0.8"), Encoding::kGzip);
  EXPECT_EQ(choose("br ; q=0.5 , gzip; Q=0.4"), Encoding::kBrotli);
  EXPECT_EQ(choose("br;q=0, *"), Encoding::kGzip);
  EXPECT_EQ(choose("*;q=0"), Encoding::kIdentity);
  EXPECT_EQ(choose("br;q=0.2, identity"), Encoding::kIdentity);
  EXPECT_EQ(choose("br;q=x"), Encoding::kIdentity);
  EXPECT_EQ(choose("br;q=1e9, gzip;q=0.1"), Encoding::kGzip);
  EXPECT_EQ(choose_encoding("br, gzip", {Encoding::kGzip}), Encoding::kGzip);
  EXPECT_EQ(choose_encoding("br, gzip", {}), Encoding::kIdentity);
}

TEST(Http, CookiesAreFound) {
  EXPECT_EQ(cookie("a=1; b=2", "b"), "2");
  EXPECT_EQ(cookie("a=1;b=2", "b"), "2");
  EXPECT_EQ(cookie("ab=1; b=", "b"), "");
  EXPECT_EQ(cookie("ab=1", "b"), "");
  EXPECT_EQ(cookie("", "b"), "");
}

TEST(Http, HostNamesLoseTheirPort) {
  EXPECT_EQ(host_name("localhost:8080"), "localhost");
  EXPECT_EQ(host_name("[::1]:8080"), "::1");
  EXPECT_EQ(host_name("127.0.0.1"), "127.0.0.1");
  EXPECT_EQ(host_name("Example.ORG."), "example.org");
  EXPECT_EQ(host_name("localhost:"), "localhost");
  EXPECT_FALSE(host_name("localhost:65536"));
  EXPECT_FALSE(host_name("[::1].evil.com"));
  EXPECT_FALSE(host_name("me@localhost"));
  EXPECT_FALSE(host_name(""));
}

TEST(Http, LoopbackIsWhatOnlyThisMachineReaches) {
  for (const char* host : {"localhost", "127.0.0.1", "127.9.9.9", "::1", "::ffff:127.0.0.1"}) {
    EXPECT_TRUE(is_loopback(host)) << host;
  }
  for (const char* host : {"localhost.example.org", "127.evil.com", "127.1", "0x7f.1", "0.0.0.0",
                           "::", "::ffff:1.2.3.4", "::127.0.0.1", "fe80::1", ""}) {
    EXPECT_FALSE(is_loopback(host)) << host;
  }
}

}  // namespace
}  // namespace clipgs
