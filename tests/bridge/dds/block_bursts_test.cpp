#include "bridge/dds/endpoints/block_bursts.hpp"

#include <gtest/gtest.h>

#include <atomic>

#include "bridge/dds/topics/topics.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "bridge/station/subscription.hpp"
#include "tests/bridge/dds/dds_support.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using namespace fieldcast::testing;

constexpr Instant kNow{std::chrono::hours{1}};

// Blocks of `buses` buses in turn, one each `distance`, for a second. Returns how many waited.
int waiting(BurstRule& rule, int buses, Duration distance, Instant begin = kNow) {
  std::array<int, 16> bus{};
  int waited = 0, number = 0;
  for (Instant now = begin; now < begin + 1s; now += distance)
    waited += rule.waits(&bus[static_cast<std::size_t>(number++ % buses)], now) ? 1 : 0;
  return waited;
}

TEST(BurstRule, BlocksOfManyBusesWaitAfterTheFirstTenWindows) {
  BurstRule rule;
  EXPECT_EQ(waiting(rule, 16, 2ms), 450);
}

TEST(BurstRule, TwoBlocksForEachWindowAreManyAndFewerAreNot) {
  BurstRule enough, fewer;
  EXPECT_EQ(waiting(enough, 2, 5ms), 180);
  EXPECT_EQ(waiting(fewer, 2, 6ms), 0);
}

TEST(BurstRule, ASingleFastBusNeverWaits) {
  BurstRule rule;
  EXPECT_EQ(waiting(rule, 1, 1ms), 0);
}

TEST(BurstRule, TheFirstBlockAfterAPauseDoesNotWait) {
  BurstRule rule;
  EXPECT_GT(waiting(rule, 16, 2ms), 0);
  EXPECT_FALSE(rule.waits(&rule, kNow + 3s));
}

// A link with two buses whose blocks and catalogue are read, and a clock that the test moves.
class Bursts : public ::testing::Test {
 protected:
  static BusSpec spec_of(const std::string& name, Duration refresh) {
    return bus_of(name, 1, [refresh](std::size_t) { return refresh; });
  }
  DdsLink::Handlers handlers() {
    auto handlers = received_.handlers();
    handlers.clock = [this] {
      UtcMapping now = both_clocks();
      now.instant = now_;
      return now;
    };
    return handlers;
  }
  void SetUp() override {
    for (const auto& [name, refresh] :
         {std::pair<std::string, Duration>{slow_, 10s}, {fast_, 50ms}})
      link_.add_bus(spec_of(name, refresh));
    ASSERT_TRUE(eventually([this] {
      publish();
      return sequences(slow_).size() > 0 && sequences(fast_).size() > 0;
    }));
  }
  // One block of each bus, at the same time of the test's clock.
  void publish() {
    ++sequence_;
    for (const std::string& bus : {slow_, fast_})
      link_.publish(bus, std::vector{good(0, 1.0, sequence_)}, both_clocks());
  }
  // Afterwards, blocks wait until the clock moves.
  void make_crowded() {
    for (int i = 0; i < 2; ++i) {
      now_ = now_.load() + BurstRule::kMeasured;
      for (int block = 0; block < BurstRule::kMany; ++block) publish();
      ASSERT_TRUE(arrives(slow_));  // no more than the socket of the reader holds
    }
  }
  std::vector<std::uint64_t> sequences(const std::string& bus) const {
    std::vector<std::uint64_t> found;
    for (const auto& [of, sequence] : samples_.all()) {
      if (of == bus) found.push_back(sequence);
    }
    return found;
  }
  // Returns true if the last sample of the bus arrives.
  bool arrives(const std::string& bus) const {
    return eventually([&] {
      const auto found = sequences(bus);
      return !found.empty() && found.back() == sequence_;
    });
  }

  std::atomic<Instant> now_{kNow};
  const std::string slow_ = bus_name("slow"), fast_ = bus_name("fast");
  std::uint64_t sequence_ = 0;
  Received received_;
  Collected<std::pair<std::string, std::uint64_t>> samples_;  // sequences, by bus
  DdsLink link_{loopback(), "test", handlers()};
  Domain reader_{loopback(), "reader", nullptr};
  dds::DataReader* const catalogue_ =
      reader_.reader(kCatalogueBlockTopic, nullptr, dds::StatusMask::none());
  const Subscription<idl::SampleBlockPubSubType> blocks_{
      reader_, kSampleBlockTopic, {.sample = [this](const idl::SampleBlock& block) {
        if (!block.snapshot()) samples_.add({block.bus().c_str(), block.sequences().front()});
      }}};
};

TEST_F(Bursts, EachBlockArrivesInItsOrderAndOnlyABusOfSlowRefreshWaits) {
  EXPECT_EQ(link_.counters(slow_).waited, 0u);
  make_crowded();
  EXPECT_GT(link_.counters(slow_).waited, 0u);
  EXPECT_EQ(link_.counters(fast_).waited, 0u);
  const auto found = sequences(slow_);
  EXPECT_EQ(found.back() - found.front() + 1, found.size()) << "each sample once, in order";
}

TEST_F(Bursts, ABusThatPromisesAShorterRefreshWaitsNoMore) {
  link_.set_refresh(slow_, 0, 50ms);
  make_crowded();
  EXPECT_EQ(link_.counters(slow_).waited, 0u);
  link_.set_refresh(slow_, 0, 1s);
  make_crowded();
  EXPECT_GT(link_.counters(slow_).waited, 0u);
}

TEST_F(Bursts, NoBlockWaitsWhileSamplesAreReadOneByOne) {
  Station single(loopback(), "single");
  std::atomic<bool> is_read = false;
  single.subscribe_samples(
      [&](const StationSample& sample) { is_read = is_read || sample.bus == slow_; }, {},
      {.deadline = 20s});
  ASSERT_TRUE(eventually([&] {
    publish();
    return is_read.load();
  }));
  make_crowded();
  EXPECT_EQ(link_.counters(slow_).waited, 0u);
}

TEST_F(Bursts, ARemovedBusWritesTheBlockThatWaits) {
  make_crowded();
  const std::uint64_t before = link_.counters(slow_).waited;
  publish();
  ASSERT_EQ(link_.counters(slow_).waited, before + 1);
  link_.remove_bus(slow_, 10s);
  EXPECT_TRUE(arrives(slow_));
}

TEST_F(Bursts, ALinkThatClosesWritesTheBlocksThatWait) {
  make_crowded();
  publish();
  link_.close(10s);
  EXPECT_TRUE(arrives(slow_));
}

}  // namespace
}  // namespace fieldcast
