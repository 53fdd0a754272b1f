#include "tour/tour_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using ::testing::HasSubstr;

class TourFile : public ::testing::Test {
 protected:
  /// What reading such a file says; "": nothing.
  std::string refusal(const std::string& text) {
    write_text(folder_ / "a.tour.json", text);
    try {
      read_tour(folder_ / "a.tour.json");
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  static std::string with_stop(const std::string& stop) {
    return R"({"clipgs_tour":1,"volume":"abc","stops":[)" + stop + "]}";
  }

  const TestFolder folder_;
};

TEST_F(TourFile, IsReadWhole) {
  EXPECT_EQ(refusal(with_stop(R"({"id":"1","name":"Größe","text":"a\nb","show":"view=1,2",)"
                              R"("fly":0,"stay":12.5,"newer":{}},{"id":"2","show":""})")),
            "");
  const Tour tour = read_tour(folder_ / "a.tour.json");
  EXPECT_EQ(tour.volume, "abc");
  ASSERT_EQ(tour.stops.size(), 2U);
  EXPECT_EQ(tour.stops[0].name, "Größe");
  EXPECT_EQ(tour.stops[0].text, "a\nb");
  EXPECT_EQ(tour.stops[0].show, "view=1,2");
  EXPECT_EQ(tour.stops[0].fly, 0);
  EXPECT_EQ(tour.stops[0].stay, 12.5);
  EXPECT_EQ(tour.stops[1].fly, 3);
  EXPECT_EQ(tour.stops[1].stay, 5);
}

TEST_F(TourFile, SaysInALineWhatIsWrong) {
  for (const std::string& text : {std::string(), std::string("[]"), std::string("{}"),
                                  std::string("null"), std::string("\xff")}) {
    EXPECT_THAT(refusal(text), HasSubstr("a.tour.json: not a tour")) << text;
  }
  EXPECT_THAT(refusal(R"({"clipgs_tour":2,"stops":[]})"), HasSubstr("newer clipgs"));
  EXPECT_THAT(refusal(with_stop("")), HasSubstr("has no stops"));
  EXPECT_THAT(refusal(with_stop(R"({"show":1})")), HasSubstr("stops[0]: \"show\""));
  EXPECT_THAT(refusal(with_stop(R"({"show":"","fly":-1})")), HasSubstr("\"fly\""));
  EXPECT_THAT(refusal(with_stop(R"({"show":"","stay":601})")), HasSubstr("\"stay\""));
  EXPECT_THAT(refusal(with_stop(R"({"show":"","name":7})")), HasSubstr("\"name\""));
  std::string many = "{\"show\":\"\"}";
  for (int i = 0; i < 100; ++i) {
    many += ",{\"show\":\"\"}";
  }
  EXPECT_THAT(refusal(with_stop(many)), HasSubstr("\"stops\""));
  EXPECT_EQ(refusal(with_stop("{\"show\":\"\"}")), "");
}

}  // namespace
}  // namespace clipgs
