#include "archive/multipart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kType = "multipart/related; type=\"application/dicom\"; boundary=\"ab\"";

/// What a message in pieces of `piece` bytes holds; a part that does not end is "…".
std::vector<std::string> parts_of(const std::string& message, size_t piece,
                                  bool* complete = nullptr, const std::string& type = kType) {
  std::vector<std::string> parts;
  MultipartReader reader(
      type, "archive",
      {[&] { parts.emplace_back("…"); }, [&](std::string_view bytes) { parts.back() += bytes; },
       [&] { parts.back().erase(0, std::string("…").size()); }});
  for (size_t at = 0; at < message.size(); at += piece) {
    reader.read(std::string_view(message).substr(at, piece));
  }
  if (complete != nullptr) {
    *complete = reader.is_complete();
  }
  return parts;
}

TEST(Multipart, PartsAreTheSameHoweverTheMessageIsCut) {
  const std::string near_misses = "\r\n--a\r\n--abc\r\n--ab-\r\n\r\n-\r";
  const std::string message =
      "passed over\r\n--ab\r\nContent-Type: application/dicom\r\nX: y\r\n\r\nfirst" + near_misses +
      "\r\n--ab \t\r\n\r\nsecond\r\n--ab\r\n\r\n\r\n--ab--\r\npassed over\r\n--ab\r\n\r\nno\r\n";
  for (size_t piece = 1; piece <= message.size(); ++piece) {
    bool complete = false;
    EXPECT_THAT(parts_of(message, piece, &complete),
                ElementsAre("first" + near_misses, "second", ""))
        << piece;
    EXPECT_TRUE(complete) << piece;
  }
}

TEST(Multipart, AnEndThatIsMissingIsKnown) {
  const std::string whole = "--ab\r\n\r\none\r\n--ab\r\n\r\ntwo\r\n--ab--";
  for (size_t size = 0; size <= whole.size(); ++size) {
    bool complete = false;
    const std::vector<std::string> parts = parts_of(whole.substr(0, size), 3, &complete);
    EXPECT_EQ(complete, size == whole.size()) << size;
    EXPECT_TRUE(parts.size() < 2 || parts[0] == "one");
  }
}

TEST(Multipart, BoundariesAreReadAsHeadersHaveThem) {
  EXPECT_EQ(header_parameter("multipart/related; boundary=a-b", "boundary"), "a-b");
  EXPECT_EQ(header_parameter("multipart/related;type=\"x;boundary=no\" ; BOUNDARY = \"a b\"; z",
                             "boundary"),
            "a b");
  EXPECT_EQ(header_parameter("multipart/related; boundaryx=a", "boundary"), "");
  EXPECT_THAT(
      parts_of("--x y\r\n\r\n1\r\n--x y--", 1, nullptr, "Multipart/Related;boundary=\"x y\""),
      ElementsAre("1"));
}

TEST(Multipart, WhatIsNoneIsRefused) {
  for (const std::string& type :
       {std::string("text/html"), std::string("application/dicom; boundary=ab"),
        std::string("multipart/related"), std::string("multipart/related; boundary=\"\""),
        "multipart/related; boundary=" + std::string(300, 'a')}) {
    EXPECT_THAT(error_of([&] { parts_of("", 1, nullptr, type); }), HasSubstr("archive: ")) << type;
  }
  const std::string headers = "--ab\r\n" + std::string(MultipartReader::kMostHeaders + 1, 'x');
  EXPECT_THAT(error_of([&] { parts_of(headers, 1000); }), HasSubstr("headers without an end"));
  const std::string blanks = "--ab" + std::string(1000, ' ');
  EXPECT_THAT(error_of([&] { parts_of(blanks, 100); }), HasSubstr("boundary without an end"));
}

}  // namespace
}  // namespace clipgs
