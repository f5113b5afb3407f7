#include "bridge/history/history_queue.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

WaitingRequest of(const std::string& requester, std::uint64_t id = 1) {
  return {.request = {.requester = requester, .request_id = id}};
}

TEST(HistoryQueue, ALaterRequestReplacesTheWaitingOneOfItsRequester) {
  HistoryQueue queue;
  queue.put(of("a", 1));
  queue.put(of("b", 1));
  queue.put(of("a", 2));
  EXPECT_EQ(queue.take()->request.request_id, 2u);
  EXPECT_EQ(queue.take()->request.requester, "b");
  EXPECT_FALSE(queue.take());
}

TEST(HistoryQueue, AHundredRequestsAreEightServedEightRefusedAndTheRestDropped) {
  HistoryQueue queue;
  for (int i = 0; i < 100; ++i) queue.put(of(std::to_string(i)));
  std::size_t served = 0, refused = 0;
  while (const auto waiting = queue.take())
    ++(waiting->refusal == HistoryOutcome::kBusy ? refused : served);
  EXPECT_EQ(served, HistoryQueue::kMostServed);
  EXPECT_EQ(refused, HistoryQueue::kMostRefused);
  EXPECT_TRUE(queue.empty());
}

}  // namespace
}  // namespace fieldcast
