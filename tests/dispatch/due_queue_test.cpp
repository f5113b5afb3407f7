#include <gtest/gtest.h>

#include <map>
#include <random>

#include "core/dispatch/policy/dispatch_state.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

Instant at(std::uint64_t nanoseconds) {
  return Instant{Duration{static_cast<Duration::rep>(nanoseconds)}};
}

TEST(DueQueue, TheTopIsTheSmallestWhateverIsPutMovedAndTakenOut) {
  constexpr std::uint32_t kIds = 50;
  std::mt19937_64 random(1);
  DueQueue queue(kIds);
  std::map<std::uint32_t, Instant> expected;
  for (int step = 0; step < 20'000; ++step) {
    const auto id = static_cast<std::uint32_t>(random() % kIds);
    if (random() % 3 == 0) {
      queue.remove(id);
      expected.erase(id);
    } else {
      const Instant key = at(random() % 1000);
      queue.put(id, key);
      expected[id] = key;
    }
    ASSERT_EQ(queue.size(), expected.size());
    ASSERT_EQ(queue.holds(id), expected.contains(id));
    if (expected.empty()) continue;
    Instant least = kNever;
    for (const auto& [each, key] : expected) least = std::min(least, key);
    ASSERT_EQ(queue.top_key(), least);
    ASSERT_EQ(expected[queue.top()], least);
  }
}

}  // namespace
}  // namespace fieldcast
