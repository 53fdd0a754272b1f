#include "study/delimited_text.h"

#include <algorithm>
#include <array>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"

namespace clipgs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::array<std::string_view, 2> kWanted{"a", "b"};

DelimitedText read_table(std::string_view text) { return read_delimited(text, "t.csv", kWanted); }

void expect_no_table(std::string_view text, const std::string& says) {
  try {
    read_table(text);
    ADD_FAILURE() << "was read: " << text;
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr(says));
  }
}

TEST(DelimitedText, FindsTheSeparator) {
  for (const char separator : {',', ';', '\t'}) {
    std::string text = "A|b|c\n1|2|3\n";
    std::ranges::replace(text, '|', separator);
    const DelimitedText table = read_table(text);
    EXPECT_EQ(table.separator, separator);
    EXPECT_THAT(table.header.cells, ElementsAre("A", "b", "c"));
    ASSERT_EQ(table.records.size(), 1);
    EXPECT_THAT(table.records[0].cells, ElementsAre("1", "2", "3"));
    EXPECT_EQ(table.records[0].line, 2);
  }
  EXPECT_THAT(read_table("a;b;c,d\n1;2,5;3\n").records[0].cells, ElementsAre("1", "2,5", "3"));
}

TEST(DelimitedText, PassesOverMarkCommentsAndEmptyLines) {
  const DelimitedText table =
      read_table("\xEF\xBB\xBF# synthetic, with a \"quote\n#\n\n  \na,b\r\n\r\n1 , 2\r\n\n3,4");
  ASSERT_EQ(table.records.size(), 2);
  EXPECT_EQ(table.header.line, 5);
  EXPECT_THAT(table.records[0].cells, ElementsAre("1", "2"));
  EXPECT_EQ(table.records[0].line, 7);
  EXPECT_THAT(table.records[1].cells, ElementsAre("3", "4"));
  EXPECT_EQ(table.records[1].line, 9);
}

TEST(DelimitedText, ReadsQuotes) {
  const DelimitedText table = read_table("a,b\n\"x, \"\"y\"\"\n z\" ,\"\"\n1,2\n");
  ASSERT_EQ(table.records.size(), 2);
  EXPECT_THAT(table.records[0].cells, ElementsAre("x, \"y\"\n z", ""));
  EXPECT_EQ(table.records[0].line, 2);
  EXPECT_EQ(table.records[1].line, 4);
}

TEST(DelimitedText, KeepsEmptyCells) {
  EXPECT_THAT(read_table("a,b,c\n,2,\n").records[0].cells, ElementsAre("", "2", ""));
  EXPECT_THAT(read_table("a\tb\tc\n\t2\t\n").records[0].cells, ElementsAre("", "2", ""));
  EXPECT_THAT(read_table("a\tb\tc\n1\t\t\n").records[0].cells, ElementsAre("1", "", ""));
}

TEST(DelimitedText, SaysWhereItIsWrong) {
  expect_no_table("", "t.csv:1: the header has no columns \"a\" and \"b\"");
  expect_no_table("# nothing else\n", "t.csv:2: the header");
  expect_no_table("a b\n1,2\n", "t.csv:1: the header");
  expect_no_table("a,b\n1,2\n1,2,3\n", "t.csv:3: has 3 cells, the header 2");
  expect_no_table("a,b\n1\n", "t.csv:2: has 1 cells, the header 2");
  expect_no_table("a,b\n1,\"2\n3,4\n", "t.csv:2: a quote is not closed");
  expect_no_table("a,b\n1,\"2\" x\n", "t.csv:2: there is text behind a quoted cell");
  expect_no_table("a,b\n1,x\"2\"\n", "t.csv:2: there is a quote inside a cell");
  expect_no_table("a,b\n1,2\nM\xFCller,2\n", "t.csv:3: is not UTF-8");
  expect_no_table("a,b\n1,\xED\xA0\x80\n", "t.csv:2: is not UTF-8");
  expect_no_table("a,b\n1,\xC3", "t.csv:2: is not UTF-8");
}

TEST(DelimitedText, QuotesWhatItMust) {
  EXPECT_EQ(delimited_cell("plain text", ','), "plain text");
  EXPECT_EQ(delimited_cell("a,b", ','), "\"a,b\"");
  EXPECT_EQ(delimited_cell("a,b", ';'), "a,b");
  EXPECT_EQ(delimited_cell("say \"x\"", ','), "\"say \"\"x\"\"\"");
  EXPECT_EQ(delimited_cell(" x", ','), "\" x\"");
}

TEST(DelimitedText, KnowsPlainText) {
  EXPECT_TRUE(is_plain_text("Größe − 1 µm 😀"));
  EXPECT_FALSE(is_plain_text("a\nb"));
  EXPECT_FALSE(is_plain_text(std::string_view("a\0b", 3)));
  EXPECT_FALSE(is_plain_text("\xFF"));
}

}  // namespace
}  // namespace clipgs
