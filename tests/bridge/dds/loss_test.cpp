// Tests that a station is complete after datagrams were lost. Only this process loses datagrams
// (lossy_receive.hpp), both of the bridge's link and of the station.
#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <map>
#include <mutex>

#include "bridge/dds/library/fastdds.hpp"
#include "bridge/dds/topics/topics.hpp"
#include "tests/bridge/dds/dds_support.hpp"
#include "tools/bench/support/lossy_receive.hpp"

namespace {

std::atomic<const char*> refused_topic = "";  // its writers take no message

#if FASTDDS_VERSION_MAJOR >= 3
using Written = eprosima::fastdds::dds::ReturnCode_t;
using Data = const void* const;
constexpr const char* kWrite = "_ZN8eprosima7fastdds3dds10DataWriter5writeEPKv";
constexpr Written kRefused = eprosima::fastdds::dds::RETCODE_TIMEOUT;
#else
using Written = bool;
using Data = void*;
constexpr const char* kWrite = "_ZN8eprosima7fastdds3dds10DataWriter5writeEPv";
constexpr Written kRefused = false;
#endif

}  // namespace

// Replaces that of the library.
Written eprosima::fastdds::dds::DataWriter::write(Data data) {
  if (get_topic()->get_name() == refused_topic.load()) return kRefused;
  static const auto library =
      reinterpret_cast<Written (*)(DataWriter*, Data)>(::dlsym(RTLD_NEXT, kWrite));
  return library(this, data);
}

namespace fieldcast::testing {
namespace {

class Loss {
 public:
  explicit Loss(double share) { bench::lose(share); }
  ~Loss() { bench::lose(0); }
  Loss(const Loss&) = delete;
  Loss& operator=(const Loss&) = delete;
};

class LastSequences {
 public:
  explicit LastSequences(bool one_by_one = false) : station(loopback(), "loss") {
    station.subscribe_samples(
        [this](const StationSample& sample) {
          const std::lock_guard lock(mutex_);
          last_[sample.bus + '/' + sample.channel] = sample.sequence;
        },
        {}, {.deadline = {}, .on_deadline_missed = {}, .one_by_one = one_by_one});
  }
  [[nodiscard]] std::size_t at(const std::string& bus, std::uint64_t sequence) const {
    const std::lock_guard lock(mutex_);
    return static_cast<std::size_t>(std::count_if(last_.begin(), last_.end(), [&](const auto& one) {
      return one.first.starts_with(bus + '/') && one.second == sequence;
    }));
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::uint64_t> last_;

 public:
  Station station;  // last: its handler uses the members above
};

std::vector<Sample> of_each(std::size_t channels, std::uint64_t sequence) {
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < channels; ++i)
    samples.push_back(good(static_cast<ChannelIndex>(i), sequence, sequence));
  return samples;
}

TEST(RefusedWrites, ACommandThatDdsDidNotTakeFits) {
  const std::string bus = bus_name("refused-command");
  const Obedient bridge(bus);
  Station station(loopback(), "operator");
  refused_topic = kCommandTopic.name;
  const auto outcome = station.execute(write_running(bus));
  refused_topic = "";
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error(), StationFault::kNotTaken) << to_text(outcome.error());
}

TEST(RefusedWrites, OfSamplesAreReportedAgainAfterSamplesWereTaken) {
  const std::string bus = bus_name("refused-samples");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  link.add_bus(bus_of(bus, 1));
  const LastSequences seen(true);
  link.publish(bus, of_each(1, 1), both_clocks());
  ASSERT_TRUE(eventually([&] { return seen.at(bus, 1) == 1; }));
  std::uint64_t sequence = 1;
  const auto reports_after = [&](const char* topic) {
    refused_topic = topic;
    link.publish(bus, of_each(1, ++sequence), both_clocks());
    refused_topic = "";
    return received.problems.size();
  };
  EXPECT_EQ(reports_after(kSampleTopic.name), 1u);
  EXPECT_EQ(reports_after(kSampleTopic.name), 1u);
  EXPECT_EQ(reports_after(""), 1u);
  EXPECT_EQ(reports_after(kSampleTopic.name), 2u);
}

// Publishes each channel once in its own block while nothing arrives, in more blocks than the
// writer keeps. Only a snapshot can provide the first ones.
TEST(LostBlocks, AStationAsksForASnapshotAndMissesNothing) {
  constexpr std::size_t kChannels = 3 * kBlocksKept;
  constexpr std::size_t kAtOnce = 32;  // blocks, so that sockets are empty before the loss ends
  const std::string bus = bus_name("gone");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  link.add_bus(bus_of(bus, kChannels));
  link.publish(bus, of_each(kChannels, 1), both_clocks());
  LastSequences last;  // late, so that the snapshot for new readers arrives before the loss
  ASSERT_TRUE(eventually([&] { return last.at(bus, 1) == kChannels; })) << last.at(bus, 1);
  const auto before = last.station.block_counters();
  {
    const Loss everything(1);
    for (std::size_t i = 0; i < kChannels; ++i) {
      const std::uint64_t lost = bench::lost_datagrams();
      const std::vector<Sample> sample{good(static_cast<ChannelIndex>(i), std::uint64_t{2}, 2)};
      link.publish(bus, sample, both_clocks());
      if (i % kAtOnce == 0) {
        ASSERT_TRUE(eventually([&] { return bench::lost_datagrams() > lost; }));
      }
    }
    ASSERT_LT(last.at(bus, 2), kChannels);
  }
  EXPECT_TRUE(eventually([&] { return last.at(bus, 2) == kChannels; }))
      << last.at(bus, 2) << " of " << kChannels << " channels have their last value";
  const auto after = last.station.block_counters();
  EXPECT_GT(after.missing, before.missing);
  EXPECT_GT(after.requests, 0u);
}

class LossyPath : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(EachWay, LossyPath, ::testing::Bool(),
                         [](const auto& way) { return way.param ? "OneByOne" : "ByBlocks"; });

TEST_P(LossyPath, TheLastValueOfEveryChannelArrives) {
  constexpr std::size_t kChannels = 100;
  constexpr std::uint64_t kRounds = 3 * kBlocksKept;  // at least a datagram each: some are lost
  const std::string bus = bus_name(GetParam() ? "lossy-one-by-one" : "lossy-by-blocks");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  LastSequences last(GetParam());
  link.add_bus(bus_of(bus, kChannels));
  link.publish(bus, of_each(kChannels, 1), both_clocks());
  ASSERT_TRUE(eventually([&] { return last.at(bus, 1) == kChannels; })) << last.at(bus, 1);
  const std::uint64_t lost = bench::lost_datagrams();
  const Loss some(0.05);
  for (std::uint64_t round = 2; round <= kRounds; ++round)
    link.publish(bus, of_each(kChannels, round), both_clocks());
  EXPECT_TRUE(eventually([&] { return last.at(bus, kRounds) == kChannels; }))
      << last.at(bus, kRounds) << " of " << kChannels << " channels have their last value";
  EXPECT_GT(bench::lost_datagrams(), lost);
}

}  // namespace
}  // namespace fieldcast::testing
