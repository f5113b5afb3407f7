#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "bridge/base/worker.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using Clock = BoundedQueue<int>::Clock;

TEST(BoundedQueue, RefusesAtItsLimitAndLeavesTheItem) {
  BoundedQueue<std::unique_ptr<int>> queue(1);
  auto first = std::make_unique<int>(1), second = std::make_unique<int>(2);
  EXPECT_TRUE(queue.try_put(first));
  EXPECT_FALSE(queue.try_put(second));
  EXPECT_EQ(first, nullptr);
  ASSERT_NE(second, nullptr);
  EXPECT_EQ(**queue.take(), 1);
  EXPECT_TRUE(queue.try_put(second));
}

TEST(BoundedQueue, DropsItsOldestAndCountsIt) {
  BoundedQueue<int> queue(2);
  for (int i = 1; i <= 5; ++i) queue.put_newest(i);
  EXPECT_EQ(queue.dropped(), 3u);
  EXPECT_THAT(queue.take_all(), ElementsAre(4, 5));
}

TEST(BoundedQueue, WaitsForSpace) {
  BoundedQueue<int> queue(1);
  queue.put(1);
  std::thread waiting([&] { queue.put(2); });
  EXPECT_EQ(queue.take(), 1);
  EXPECT_EQ(queue.take(), 2);
  waiting.join();
}

TEST(BoundedQueue, ADeadlineEndsTheWait) {
  BoundedQueue<int> queue(1);
  EXPECT_TRUE(queue.take_all(Clock::now() + 1ms).empty());
  EXPECT_FALSE(queue.closed());
}

TEST(BoundedQueue, ClosedItGivesWhatItHasAndTakesNothing) {
  BoundedQueue<int> queue(4);
  queue.put(1);
  queue.close();
  int late = 2;
  EXPECT_FALSE(queue.try_put(late));
  EXPECT_TRUE(queue.pause(1h)) << "does not wait";
  EXPECT_EQ(queue.take(), 1);
  EXPECT_EQ(queue.take(), std::nullopt);
  EXPECT_TRUE(queue.take_all().empty());
}

TEST(Worker, WorksOffWhatWasPutAndEnds) {
  std::vector<int> done;
  Worker<int> worker("test", 8, [&](BoundedQueue<int>& queue) {
    while (const auto item = queue.take()) done.push_back(*item);
  });
  for (int i = 0; i < 5; ++i) worker.queue().put(i);
  worker.close();
  EXPECT_THAT(done, ElementsAre(0, 1, 2, 3, 4));
}

}  // namespace
}  // namespace fieldcast
