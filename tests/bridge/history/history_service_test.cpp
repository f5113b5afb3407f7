#include "bridge/history/history_service.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <string>
#include <vector>

#include "bridge/base/clock.hpp"
#include "bridge/store/store.hpp"
#include "tests/bridge/store/scratch.hpp"
#include "tests/bridge/store/store_support.hpp"

namespace fieldcast::test {
namespace {

using std::chrono::seconds;

struct HistoryServiceTest : testing::Test {
  HistoryService::Uses uses() {
    return {[](const std::string& bus) { return bus == "h"; },
            [this](const HistoryRequest& request, const HistoryResponse& response) {
              const std::lock_guard lock(mutex);
              responses.emplace_back(request, response);
              changed.notify_one();
            }};
  }
  HistoryResponse wait_for(std::size_t count = 1) {
    std::unique_lock lock(mutex);
    EXPECT_TRUE(changed.wait_for(lock, seconds{30}, [&] { return responses.size() >= count; }));
    return responses.empty() ? HistoryResponse{} : responses.back().second;
  }
  static HistoryRequest request(const std::string& bus = "h") {
    return {.requester = "r",
            .request_id = 1,
            .bus = bus,
            .until = read_clocks().utc,
            .channels = {{.device = "d", .channel = "a"}}};
  }

  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::pair<HistoryRequest, HistoryResponse>> responses;
  Scratch scratch;
};

TEST_F(HistoryServiceTest, ABridgeWithoutAStoreSaysSo) {
  HistoryService service({}, uses());
  service.receive(request(), "");
  const auto response = wait_for();
  EXPECT_EQ(response.outcome, HistoryOutcome::kNoStore);
  EXPECT_FALSE(response.reason.empty());
}

TEST_F(HistoryServiceTest, OnlyTheBridgeOfTheBusResponds) {
  HistoryService service({}, uses());
  service.receive(request("unknown"), "");
  auto second = request();
  second.requester = "second";
  service.receive(second, "");
  (void)wait_for();
  EXPECT_EQ(responses.size(), 1u);
  EXPECT_EQ(responses[0].first.requester, "second");
}

TEST_F(HistoryServiceTest, ABrokenRequestIsRefusedWithItsFault) {
  HistoryService service({}, uses());
  service.receive(request(), "rows must be from 1 to 1024");
  const auto response = wait_for();
  EXPECT_EQ(response.outcome, HistoryOutcome::kInvalid);
  EXPECT_EQ(response.reason, "rows must be from 1 to 1024");
}

TEST_F(HistoryServiceTest, AMissingStoreIsAFailureThatMayPass) {
  StoreSpec spec = forever(StoreAddress(scratch.path("later.db")));
  HistoryService service(spec, uses());
  service.receive(request(), "");
  EXPECT_EQ(wait_for().outcome, HistoryOutcome::kFailed);
  {
    Store store(spec);
    const auto intake = store.intake(bus_of("h", {"a"}));
    const Sample one[] = {sample(0, 0.5, 1)};
    intake->put(one, kClock, utc(1));
    ASSERT_TRUE(store.flush(seconds{30}));
  }
  service.receive(request(), "");
  const auto response = wait_for(2);
  EXPECT_EQ(response.outcome, HistoryOutcome::kRows);
  EXPECT_EQ(response.rows.size(), 1u);
}

TEST_F(HistoryServiceTest, ARangeBeforeTheKeptTimeIsRefused) {
  StoreSpec spec = forever(StoreAddress(scratch.path("kept.db")));
  spec.keep = std::chrono::hours{1};
  HistoryService service(spec, uses());
  HistoryRequest old = request();
  old.until = utc(0);
  service.receive(old, "");
  EXPECT_EQ(wait_for().outcome, HistoryOutcome::kNotKept);
}

TEST_F(HistoryServiceTest, AFloodOfHugeRequestsIsRefusedAndTheNextOneIsServed) {
  StoreSpec spec = forever(StoreAddress(scratch.path("flood.db")));
  Store store(spec);
  const auto intake = store.intake(bus_of("h", {"a"}));
  const Sample one[] = {sample(0, 0.5, 1)};
  intake->put(one, kClock, utc(1));
  ASSERT_TRUE(store.flush(seconds{30}));
  HistoryService service(spec, uses());
  for (int i = 0; i < 100; ++i) {
    HistoryRequest hostile = request();
    hostile.requester = std::to_string(i);
    hostile.until = kEnd;
    hostile.channels.assign(HistoryRequest::kMostChannels, hostile.channels[0]);
    service.receive(hostile, "");
  }
  const auto is_served = [&] {
    return std::ranges::any_of(responses, [](const auto& each) {
      return each.first.requester == "r" && each.second.outcome == HistoryOutcome::kRows;
    });
  };
  std::unique_lock lock(mutex);
  for (int i = 0; i < 3000 && !is_served(); ++i) {
    lock.unlock();
    service.receive(request(), "");
    lock.lock();
    changed.wait_for(lock, std::chrono::milliseconds{10}, is_served);
  }
  EXPECT_TRUE(is_served());
  const auto flood = std::ranges::count_if(
      responses, [](const auto& each) { return each.first.requester != "r"; });
  // One more may have been taken from the queue while the others arrived.
  EXPECT_LE(flood, 3 * (HistoryQueue::kMostServed + HistoryQueue::kMostRefused));
}

}  // namespace
}  // namespace fieldcast::test
