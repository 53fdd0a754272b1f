#include "serve/live_work.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace clipgs {
namespace {

using namespace std::chrono_literals;

TEST(LiveWork, TellsWhatIsMadeAndFailed) {
  LiveWork live;
  EXPECT_EQ(live.json(), nlohmann::json::array());
  live.begin("head", "instant");
  live.begin("chest", "instant");
  live.begin("head", "standard", [] { return std::optional(359.6); });
  EXPECT_EQ(live.json(), nlohmann::json::parse(R"([
    {"name": "head", "quality": "standard", "seconds": 360},
    {"name": "chest", "quality": "instant"}])"));
  live.end("chest", "the disk is full");
  live.end("head");
  live.end("nobody");
  EXPECT_EQ(live.json(), nlohmann::json::parse(R"([
    {"name": "chest", "quality": "instant", "error": "the disk is full"}])"));
  live.begin("chest", "draft");
  EXPECT_FALSE(live.json()[0].contains("error"));
}

TEST(LiveWork, IsDesertedWhenTheLastPageIsGone) {
  const LiveWork::Clock::time_point start;
  LiveWork live;
  EXPECT_FALSE(live.deserted(start + 1h));
  live.page_left("never seen", start);
  EXPECT_FALSE(live.deserted(start + 1h));
  live.page_seen("a", start);
  live.page_seen("b", start + 5s);
  live.page_left("a", start + 10s);
  EXPECT_FALSE(live.deserted(start + 60s));
  live.page_left("b", start + 70s);
  EXPECT_EQ(live.deserted(start + 73s), 3s);
  live.page_seen("a", start + 74s);  // loaded again
  EXPECT_FALSE(live.deserted(start + 75s));
}

TEST(LiveWork, PagesThatSayNothingAreGone) {
  const LiveWork::Clock::time_point start;
  LiveWork live;
  live.page_seen("a", start);
  EXPECT_FALSE(live.deserted(start + LiveWork::kSilence));
  EXPECT_EQ(live.deserted(start + LiveWork::kSilence + 1s), LiveWork::kSilence + 1s);
}

TEST(LiveWork, RemembersNoMorePagesThanItShould) {
  const LiveWork::Clock::time_point start;
  LiveWork live;
  live.page_seen(std::string(LiveWork::kPageName + 1, 'x'), start);
  EXPECT_FALSE(live.deserted(start + 1h));
  for (size_t i = 0; i < LiveWork::kPages + 10; ++i) {
    live.page_seen(std::to_string(i), start);
  }
  for (size_t i = 0; i < LiveWork::kPages; ++i) {
    live.page_left(std::to_string(i), start);
  }
  EXPECT_TRUE(live.deserted(start + 1s));
}

}  // namespace
}  // namespace clipgs
