#include "serve/connections.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <set>
#include <string>

#include "serve/throttle.h"

namespace clipgs {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Connections that say by a name each which of them were closed.
struct Room {
  explicit Room(ConnectionLimits limits) : connections(limits) {}
  Connections::Id come(const std::string& client, const std::string& name) {
    return connections.add(client, [this, name] { closed.insert(name); });
  }

  Connections connections;
  std::set<std::string> closed;
};

TEST(Connections, OfAClientWithTooManyTheOneThatWaitedLongestGoes) {
  Room room({.all = 10, .per_client = 3});
  const auto first = room.come("a", "a1");
  room.connections.set_answering(first, true);
  room.come("a", "a2");
  room.come("a", "a3");
  room.come("b", "b1");
  EXPECT_THAT(room.closed, IsEmpty());
  room.come("a", "a4");
  EXPECT_THAT(room.closed, ElementsAre("a2"));
  EXPECT_EQ(room.connections.size(), 4U);
}

TEST(Connections, WhereThereAreTooManyTheClientWithMostOfThemLosesOne) {
  Room room({.all = 4, .per_client = 4});
  room.come("b", "b1");
  room.come("a", "a1");
  room.come("a", "a2");
  room.come("a", "a3");
  room.come("c", "c1");
  EXPECT_THAT(room.closed, ElementsAre("a1"));
  room.come("c", "c2");
  EXPECT_THAT(room.closed, ElementsAre("a1", "a2"));
}

TEST(Connections, ThoseThatAreAnsweredGoWhereThereAreNoOthers) {
  Room room({.all = 10, .per_client = 2});
  room.connections.set_answering(room.come("a", "a1"), true);
  room.connections.set_answering(room.come("a", "a2"), true);
  room.come("a", "a3");
  EXPECT_THAT(room.closed, ElementsAre("a1"));
}

TEST(Connections, AreForgottenWhenTheyEnd) {
  Room room({.all = 2, .per_client = 2});
  room.connections.remove(room.come("a", "a1"));
  room.come("a", "a2");
  room.come("b", "b1");
  EXPECT_THAT(room.closed, IsEmpty());
  room.connections.close_all();
  EXPECT_THAT(room.closed, ElementsAre("a2", "b1"));
  room.connections.close_one();
  EXPECT_EQ(room.connections.size(), 0U);
  room.come("c", "c1");
  EXPECT_THAT(room.closed, ElementsAre("a2", "b1", "c1"));
}

TEST(Throttle, LetsSomeThroughAndThenFew) {
  Throttle throttle;
  Throttle::Clock::time_point now{};
  int passed = 0;
  for (int i = 0; i < 100; ++i) {
    passed += throttle.is_one_too_many("a", now) ? 0 : 1;
  }
  EXPECT_EQ(passed, 10);
  EXPECT_FALSE(throttle.is_one_too_many("b", now)) << "others do not wait";
  for (int second = 0; second < 600; ++second) {
    now += std::chrono::seconds(1);
    passed += throttle.is_one_too_many("a", now) ? 0 : 1;
  }
  EXPECT_EQ(passed, 110);
  now += std::chrono::hours(1);
  EXPECT_FALSE(throttle.is_one_too_many("a", now));
}

}  // namespace
}  // namespace clipgs
