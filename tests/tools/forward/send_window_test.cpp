#include "tools/forward/send/send_window.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace fieldcast::forward {
namespace {

Lane lane(const std::string& device, bool is_late = false) {
  return {.is_late = is_late, .bus = "line", .device = device};
}

TEST(SendWindow, OneRecordOfALaneIsInFlight) {
  SendWindow window(10);
  window.add(1, lane("a"));
  window.add(2, lane("a"));
  window.add(3, lane("b"));
  EXPECT_EQ(window.next(), 1u);
  EXPECT_EQ(window.next(), 3u);
  EXPECT_EQ(window.next(), std::nullopt);
  EXPECT_TRUE(window.finish(1));
  EXPECT_EQ(window.next(), 2u);
  EXPECT_EQ(window.in_flight(), 2u);
}

TEST(SendWindow, AFailedRecordIsSentBeforeLaterOnesOfItsLane) {
  SendWindow window(10);
  window.add(1, lane("a"));
  window.add(2, lane("a"));
  EXPECT_EQ(window.next(), 1u);
  window.fail(1);
  EXPECT_EQ(window.next(), 1u);
  EXPECT_EQ(window.next(), std::nullopt);
}

TEST(SendWindow, TheNumberInFlightIsBounded) {
  SendWindow window(2);
  window.add(1, lane("a"));
  window.add(2, lane("b"));
  window.add(3, lane("c"));
  EXPECT_EQ(window.next(), 1u);
  EXPECT_EQ(window.next(), 2u);
  EXPECT_EQ(window.next(), std::nullopt);
  window.fail(2);
  EXPECT_EQ(window.next(), 2u);
  EXPECT_TRUE(window.finish(2));
  EXPECT_EQ(window.next(), 3u);
}

TEST(SendWindow, AResultOfARecordThatIsNotInFlightHasNoEffect) {
  SendWindow window(2);
  window.add(1, lane("a"));
  EXPECT_FALSE(window.finish(1)) << "it was not sent";
  EXPECT_FALSE(window.finish(7));
  EXPECT_FALSE(window.fail(7));
  EXPECT_EQ(window.size(), 1u);
  EXPECT_EQ(window.next(), 1u);
}

TEST(SendWindow, LateRecordsAreSentWhileNoOtherCanBeSent) {
  SendWindow window(10);
  window.add(1, lane("a", true));
  window.add(2, lane("b", true));
  window.add(3, lane("a"));
  EXPECT_EQ(window.next(), 3u);
  EXPECT_EQ(window.next(false), std::nullopt);
  EXPECT_EQ(window.next(), 1u) << "the lanes of one device are independent";
  window.add(4, lane("b"));
  EXPECT_EQ(window.next(), 4u);
  EXPECT_TRUE(window.fail(1));
  EXPECT_EQ(window.next(), 1u);
  EXPECT_EQ(window.next(), 2u);
}

TEST(SendWindow, AfterClearResultsOfEarlierRecordsHaveNoEffect) {
  SendWindow window(10);
  window.add(1, lane("a"));
  EXPECT_EQ(window.next(), 1u);
  window.clear();
  EXPECT_EQ(window.size(), 0u);
  window.add(1, lane("a"));
  EXPECT_FALSE(window.finish(1));
  EXPECT_EQ(window.next(), 1u);
}

// An engine that loses messages, or acknowledgements of stored messages, and removes duplicates.
TEST(SendWindow, WithAnyFailuresEachLaneIsStoredInItsOrder) {
  std::mt19937 random(31);
  for (int round = 0; round < 50; ++round) {
    SendWindow window(1 + random() % 8);
    std::map<std::uint64_t, char> subjects;
    for (std::uint64_t id = 1; id <= 100; ++id) {
      subjects[id] = static_cast<char>('a' + random() % 5);
      window.add(id, lane(std::string(1, subjects[id])));
    }
    std::map<char, std::vector<std::uint64_t>> stored;
    std::vector<std::uint64_t> in_flight;
    while (window.size() > 0) {
      while (const auto id = window.next()) in_flight.push_back(*id);
      ASSERT_FALSE(in_flight.empty());
      const std::size_t at = random() % in_flight.size();
      const std::uint64_t id = in_flight[at];
      in_flight.erase(in_flight.begin() + static_cast<std::ptrdiff_t>(at));
      auto& subject = stored[subjects[id]];
      const auto outcome = random() % 3;
      const bool is_stored = outcome != 0;
      if (is_stored && std::ranges::find(subject, id) == subject.end()) subject.push_back(id);
      if (outcome == 2) {
        EXPECT_TRUE(window.finish(id));
      } else {
        window.fail(id);
      }
    }
    std::size_t count = 0;
    for (const auto& [subject, ids] : stored) {
      EXPECT_TRUE(std::ranges::is_sorted(ids)) << subject;
      count += ids.size();
    }
    EXPECT_EQ(count, 100u);
  }
}

}  // namespace
}  // namespace fieldcast::forward
