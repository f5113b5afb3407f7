#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <map>
#include <set>

#include "bridge/dds/endpoints/bridge_announcement.hpp"
#include "bridge/dds/endpoints/renewed_writer.hpp"
#include "bridge/dds/topics/topics.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "bridge/station/subscription.hpp"
#include "tests/bridge/dds/dds_support.hpp"

namespace fieldcast::testing {
namespace {

using namespace std::chrono_literals;

std::set<std::string> channels_of(const std::vector<StationSample>& samples,
                                  const std::string& bus) {
  std::set<std::string> names;
  for (const StationSample& sample : samples) {
    if (sample.bus == bus) names.insert(sample.channel);
  }
  return names;
}

std::vector<Sample> one_of_each(std::size_t channels, std::uint64_t sequence = 1) {
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < channels; ++i)
    samples.push_back(good(static_cast<ChannelIndex>(i), static_cast<double>(i), sequence));
  return samples;
}

TEST(DdsLink, EveryChannelOf300ArrivesFromOneRefreshClass) {
  const std::string bus = bus_name("wide");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  Collected<StationSample> samples;
  Station station(loopback(), "watcher");
  station.subscribe_samples([&](const StationSample& sample) { samples.add(sample); });
  link.add_bus(bus_of(bus, 300));
  EXPECT_EQ(link.counters(bus).sample_writers, 2u) << "256 channels at most for one writer";

  link.publish(bus, one_of_each(300), both_clocks());
  ASSERT_TRUE(eventually([&] { return channels_of(samples.all(), bus).size() == 300; }))
      << channels_of(samples.all(), bus).size() << " of 300 channels came";
  for (const StationSample& sample : samples.all()) {
    if (sample.bus != bus) continue;
    EXPECT_EQ("c" + to_text(sample.value), sample.channel);
    EXPECT_EQ(sample.device, "d");
    EXPECT_EQ(sample.quality, Quality::kGood);
  }
  EXPECT_THAT(received.problems.all(), ::testing::IsEmpty());
}

// Two masters that start before they discover each other: one of them steps back.
TEST(DdsLink, TheChannelsOfABridgeRemainWhenASecondBridgeOfALaterEpochHasLeft) {
  const std::string bus = bus_name("twice");
  Received of_first, of_second;
  DdsLink first(loopback(), "first", of_first.handlers());
  first.add_bus(bus_of(bus, 2));
  auto second = std::make_unique<DdsLink>(loopback(), "second", of_second.handlers());
  second->add_bus(bus_of(bus, 3));
  Collected<StationSample> samples;  // outlives the station, whose thread adds to it
  Station station(loopback(), "watcher");
  station.subscribe_samples([&](const StationSample& sample) { samples.add(sample); });
  second->publish(bus, one_of_each(3), both_clocks());
  ASSERT_TRUE(eventually([&] { return channels_of(samples.all(), bus).size() == 3; }));

  second.reset();
  std::uint64_t sequence = 100;
  EXPECT_TRUE(eventually([&] {
    first.publish(bus, one_of_each(2, ++sequence), both_clocks());
    const auto all = samples.all();
    return std::any_of(all.begin(), all.end(), [&](const StationSample& sample) {
      return sample.bus == bus && sample.sequence > 100;
    });
  }));
}

// Bridges that were discovered before the listener exists are reported in the constructor.
TEST(BridgeAnnouncement, HearsOfBridgesThatAreThereBeforeIt) {
  const DdsSpec spec = loopback();
  Domain there(spec, "there", nullptr), here(spec, "here", nullptr);
  const RequestWriters without_security;
  const auto no_problem = [](const std::string& text) { ADD_FAILURE() << text; };
  BridgeAnnouncement first(there, without_security, "first", unheard(), no_problem);
  first.announce({.bridge = "first"});
  std::atomic<bool> known = false;
  const Subscription<idl::BridgePubSubType> watching(
      here, kBridgeTopic, {.sample = [&](const idl::Bridge&) { known = true; }});
  ASSERT_TRUE(eventually([&] { return known.load(); }));
  Collected<std::string> found, said;
  DdsLink::BridgeHandlers handlers = unheard();
  handlers.found = [&](const std::string& id) { found.add(id); };
  handlers.received = [&](const std::string& id, const BridgeClaims&) { said.add(id); };
  BridgeAnnouncement second(here, without_security, "second", handlers, no_problem);
  EXPECT_EQ(found.all(), std::vector<std::string>{first.id()});
  EXPECT_TRUE(eventually([&] { return said.size() == 1; }));
  second.close();
  first.close();
}

// With a single writer, a reader's discovery time would grow with the square of the channels.
TEST(DdsLink, TheKeyedCatalogueIsSplitAmongWriters) {
  constexpr std::size_t kChannels = 2 * kChannelsPerCatalogueWriter + 1;
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  link.add_bus(bus_of(bus_name("split"), kChannels));
  Domain domain(loopback(), "reader", nullptr);
  dds::DataReader* const reader = domain.reader(kChannelTopic, nullptr, dds::StatusMask::none());
  std::set<std::string> channels;
  std::set<dds::InstanceHandle_t> writers;
  EXPECT_TRUE(eventually([&] {
    idl::Channel entry;
    dds::SampleInfo info;
    while (reader->take_next_sample(&entry, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      channels.insert(entry.channel().c_str());
      writers.insert(info.publication_handle);
    }
    return channels.size() == kChannels;
  })) << channels.size()
      << " channels came";
  EXPECT_EQ(writers.size(), 3u);
}

// Stations may join while a standby stops. Its listeners use what is destroyed before the writers.
TEST(DdsLink, AClosedLinkHasNoWritersOfAPreparedBus) {
  Domain domain(loopback(), "reader", nullptr);
  dds::DataReader* const reader =
      domain.reader(kSampleBlockTopic, nullptr, dds::StatusMask::none());
  const auto writers = [&] {
    dds::SubscriptionMatchedStatus status;
    (void)reader->get_subscription_matched_status(status);
    return status.current_count;
  };
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  link.prepare_bus(bus_of(bus_name("prepared"), 1));
  ASSERT_TRUE(eventually([&] { return writers() == 1; }));
  link.close();
  EXPECT_TRUE(eventually([&] { return writers() == 0; }));
}

TEST(DdsLink, LateJoinerGetsTheCatalogueAndTheLastValueOfEveryChannel) {
  const std::string bus = bus_name("late");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  link.add_bus(bus_of(bus, 300));
  for (std::uint64_t sequence = 1; sequence <= 3; ++sequence)
    link.publish(bus, one_of_each(300, sequence), both_clocks());

  Collected<StationSample> samples;
  Collected<StationChannel> channels;
  Station station(loopback(), "late");
  station.subscribe_samples([&](const StationSample& sample) { samples.add(sample); });
  station.subscribe_channels([&](const StationChannel& channel) {
    if (channel.bus == bus) channels.add(channel);
  });
  ASSERT_TRUE(eventually([&] {
    return channels_of(samples.all(), bus).size() == 300 && channels.size() == 300;
  })) << channels_of(samples.all(), bus).size()
      << " values and " << channels.size() << " catalogue entries of 300";
  for (const StationSample& sample : samples.all())
    EXPECT_EQ(sample.sequence, 3u) << "only the last value";
  EXPECT_EQ(channels.all().front().refresh, 10s);
  EXPECT_EQ(channels.all().front().bridge, "test");
}

TEST(DdsLink, StationThatAsksForADeadlineGetsJustTheChannelsThatPromiseIt) {
  const std::string bus = bus_name("mixed");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  link.add_bus(
      bus_of(bus, 20, [](std::size_t i) { return i % 2 == 0 ? Duration{5s} : Duration{60s}; }));
  Collected<StationSample> fresh, all;
  Station demanding(loopback(), "demanding"), content(loopback(), "content");
  demanding.subscribe_samples([&](const StationSample& sample) { fresh.add(sample); }, {},
                              {.deadline = 10s});
  content.subscribe_samples([&](const StationSample& sample) { all.add(sample); });
  link.publish(bus, one_of_each(20), both_clocks());
  ASSERT_TRUE(eventually([&] {
    return channels_of(all.all(), bus).size() == 20 && channels_of(fresh.all(), bus).size() == 10;
  })) << channels_of(all.all(), bus).size()
      << " of 20, " << channels_of(fresh.all(), bus).size() << " of 10";
  for (const StationSample& sample : fresh.all())
    EXPECT_EQ(static_cast<int>(std::get<double>(sample.value)) % 2, 0);
}

TEST(DdsLink, TheStationIsNotifiedOfTheChannelThatMissedItsDeadline) {
  const std::string bus = bus_name("late-channel");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  link.add_bus(bus_of(bus, 2, [](std::size_t) { return 100ms; }));
  Collected<std::string> late;
  Collected<StationSample> samples;
  Station station(loopback(), "demanding");
  station.subscribe_samples(
      [&](const StationSample& sample) { samples.add(sample); }, {},
      {.deadline = 100ms,
       .on_deadline_missed = [&](const std::string& of, const std::string& device,
                                 const std::string& name) { late.add(of + device + name); }});
  link.publish(bus, one_of_each(2), both_clocks());
  std::uint64_t sequence = 1;
  EXPECT_TRUE(eventually([&] {
    link.publish(bus, std::vector{good(0, 1.0, ++sequence)}, both_clocks());
    const auto names = late.all();
    return std::count(names.begin(), names.end(), bus + "dc1") >= 2;
  }));
  EXPECT_EQ(samples.all().front().path().substr(0, bus.size() + 4), bus + "/d/c");
}

struct OneByOne {
  explicit OneByOne(const std::string& name) : station(loopback(), name) {
    station.subscribe_samples([this](const StationSample& sample) { samples.add(sample); }, {},
                              {.one_by_one = true});
  }
  Collected<StationSample> samples;
  Station station;
};

TEST(DdsLink, MissedPromisesAreCounted) {
  const std::string bus = bus_name("missed");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  link.add_bus(bus_of(bus, 2, [](std::size_t) { return 50ms; }));
  const OneByOne reader("reader");
  link.publish(bus, one_of_each(2), both_clocks());
  EXPECT_TRUE(eventually([&] { return link.counters(bus).deadline_misses >= 2; }));
}

TEST(DdsLink, NothingIsMissedBeforeTheFirstSample) {
  const std::string bus = bus_name("unwritten");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  const OneByOne reader("reader");
  BusSpec spec = bus_of(bus, 2, [](std::size_t i) { return i == 0 ? 20ms : 10s; });
  spec.devices[0].channels[0].name = "silent";
  link.add_bus(spec);
  // The other class serves as the clock: its deadline is ten refreshes of the first.
  BusSpec other = bus_of(bus + "x", 1, [](std::size_t) { return 200ms; });
  link.add_bus(other);
  link.publish(bus + "x", one_of_each(1), both_clocks());
  ASSERT_TRUE(eventually([&] { return link.counters(bus + "x").deadline_misses >= 1; }));
  EXPECT_EQ(link.counters(bus).deadline_misses, 0u);
}

TEST(DdsLink, WhoReadsSamplesOneByOneGetsEveryLastValueFirstAndThenEverySample) {
  const std::string bus = bus_name("first");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  link.add_bus(bus_of(bus, 300));
  for (std::uint64_t sequence = 1; sequence <= 3; ++sequence)
    link.publish(bus, one_of_each(300, sequence), both_clocks());
  const OneByOne reader("reader");
  ASSERT_TRUE(eventually([&] { return channels_of(reader.samples.all(), bus).size() == 300; }))
      << channels_of(reader.samples.all(), bus).size() << " of 300 channels came";
  for (const StationSample& sample : reader.samples.all())
    EXPECT_EQ(sample.sequence, 3u) << "the last value, and no value twice";

  for (std::uint64_t sequence = 4; sequence <= 6; ++sequence) {
    link.publish(bus, std::vector{good(7, 0.5, sequence)}, both_clocks());
    ASSERT_TRUE(eventually([&] { return reader.samples.size() == 297 + sequence; }));
    EXPECT_EQ(reader.samples.all().back().sequence, sequence);
  }
}

// `ahead`: seconds.
DdsLink::Handlers with_clock(DdsLink::Handlers handlers, const std::atomic<int>& ahead) {
  handlers.clock = [&ahead] {
    UtcMapping now = both_clocks();
    now.instant += std::chrono::seconds{ahead};
    return now;
  };
  return handlers;
}

TEST(DdsLink, SampleWritersRestAfterTheirLastReaderAndServeTheNextOne) {
  const std::string bus = bus_name("resting");
  Received received;
  std::atomic<int> ahead = 0;  // seconds
  const DdsLink::Handlers handlers = with_clock(received.handlers(), ahead);
  DdsLink link(loopback(), "test", handlers);
  link.add_bus(bus_of(bus, 2, [](std::size_t) { return 20ms; }));
  const auto report = [&] { link.report(bus, BusReport{}, both_clocks().utc); };
  {
    const OneByOne reader("one");
    link.publish(bus, one_of_each(2), both_clocks());
    ASSERT_TRUE(eventually([&] { return link.counters(bus).deadline_misses >= 2; }));
  }
  ASSERT_TRUE(eventually([&] { return link.counters(bus).sample_readers == 0; }));
  report();
  ahead = 11;
  report();
  const std::uint64_t misses = link.counters(bus).deadline_misses;
  EXPECT_GE(misses, 2u) << "what was missed stays missed";
  link.publish(bus, one_of_each(2, 2), both_clocks());
  const OneByOne reader("two");
  ASSERT_TRUE(eventually([&] { return channels_of(reader.samples.all(), bus).size() == 2; }));
  for (const StationSample& sample : reader.samples.all()) EXPECT_EQ(sample.sequence, 2u);
}

// A reader of the library counts one by one up to the first message of a writer that it can get.
TEST(DdsLink, WritersThatHaveWrittenManyMessagesAreReplaced) {
  const std::string bus = bus_name("renewed");
  Received received;
  std::atomic<int> ahead = 0;  // seconds
  const DdsLink::Handlers handlers = with_clock(received.handlers(), ahead);
  DdsLink link(loopback(), "test", handlers);
  link.add_bus(bus_of(bus, 2));
  const OneByOne each("each");
  std::atomic<std::uint64_t> last = 0;
  Station by_block(loopback(), "by block");
  by_block.subscribe_samples([&](const StationSample& sample) {
    if (sample.bus == bus) last = sample.sequence;
  });
  ASSERT_TRUE(eventually([&] {
    const auto counters = link.counters(bus);
    return counters.block_readers > 0 && counters.sample_readers > 0;
  }));
  std::uint64_t sequence = 0;
  while (sequence < RenewedWriter::kMostMessages)
    link.publish(bus, one_of_each(2, ++sequence), both_clocks());
  for (ahead = 10; ahead <= 40; ahead += 10) link.report(bus, BusReport{}, both_clocks().utc);

  link.publish(bus, one_of_each(2, ++sequence), both_clocks());
  EXPECT_TRUE(eventually([&] { return last == sequence; }));
  EXPECT_TRUE(eventually([&] { return each.samples.all().back().sequence == sequence; }));
  EXPECT_EQ(link.counters(bus).sample_writers, 1u);
  Domain late(loopback(), "late", nullptr);
  const auto number_of = [&](auto&& topic, auto message) {
    dds::DataReader* reader = late.reader(topic, nullptr, dds::StatusMask::none());
    dds::SampleInfo info;
    EXPECT_TRUE(eventually(
        [&] { return reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK; }));
    late.remove(reader);
    return info.sample_identity.sequence_number().to64long();
  };
  EXPECT_LT(number_of(kSampleTopic, idl::Sample{}), 10);
  EXPECT_LT(number_of(kSampleBlockTopic, idl::SampleBlock{}), 10);
}

TEST(DdsLink, ChangedRefreshMovesTheChannelWithItsValueAndItsCatalogueEntry) {
  const std::string bus = bus_name("moving");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  link.add_bus(bus_of(bus, 4, [](std::size_t) { return 60s; }));
  link.publish(bus, one_of_each(4), both_clocks());
  Collected<StationSample> fresh, all;
  Collected<std::string> gone;
  Station demanding(loopback(), "demanding"), content(loopback(), "content");
  std::mutex mutex;
  std::map<std::string, Duration> refresh;
  demanding.subscribe_samples([&](const StationSample& sample) { fresh.add(sample); }, {},
                              {.deadline = 1s});
  content.subscribe_samples([&](const StationSample& sample) { all.add(sample); },
                            [&](const std::string&, const std::string&,
                                const std::string& channel) { gone.add(channel); });
  content.subscribe_channels([&](const StationChannel& channel) {
    const std::lock_guard lock(mutex);
    if (channel.bus == bus) refresh[channel.channel] = channel.refresh;
  });
  ASSERT_TRUE(eventually([&] { return channels_of(all.all(), bus).size() == 4; }));
  EXPECT_EQ(link.counters(bus).sample_writers, 1u);

  link.set_refresh(bus, 2, 500ms);
  EXPECT_EQ(link.counters(bus).sample_writers, 2u);
  EXPECT_TRUE(eventually([&] {
    return channels_of(fresh.all(), bus) == std::set<std::string>{"c2"};
  })) << "the station that asks for 1 s sees it now";
  EXPECT_TRUE(eventually([&] {
    const std::lock_guard lock(mutex);
    return refresh["c2"] == 500ms && refresh["c1"] == 60s;
  })) << "and the catalogue says so";

  link.set_refresh(bus, 2, 60s);  // back: the writer of the interest has left
  EXPECT_EQ(link.counters(bus).sample_writers, 1u);
  link.publish(bus, one_of_each(4, 2), both_clocks());
  EXPECT_TRUE(eventually([&] {
    const auto seen = all.all();
    return std::any_of(seen.begin(), seen.end(),
                       [](const StationSample& s) { return s.channel == "c2" && s.sequence == 2; });
  }));
  EXPECT_THAT(gone.all(), ::testing::IsEmpty()) << "a channel that moves never looks gone";
}

TEST(DdsLink, RemovedBusIsSeenToGoAndComesBackUnderTheSameName) {
  const std::string bus = bus_name("removed");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  Collected<std::string> gone_samples, gone_channels;
  Collected<StationSample> samples;
  Collected<StationChannel> channels;
  Station station(loopback(), "watcher");
  station.subscribe_samples([&](const StationSample& sample) { samples.add(sample); },
                            [&](const std::string&, const std::string&, const std::string& name) {
                              gone_samples.add(name);
                            });
  station.subscribe_channels([&](const StationChannel& channel) { channels.add(channel); },
                             [&](const std::string&, const std::string&, const std::string& name) {
                               gone_channels.add(name);
                             });
  for (std::size_t round = 1; round <= 2; ++round) {
    link.add_bus(bus_of(bus, 5));
    link.publish(bus, one_of_each(5), both_clocks());
    ASSERT_TRUE(eventually([&] {
      return samples.size() == 5 * round && channels.size() == 5 * round;
    })) << samples.size()
        << " samples, " << channels.size() << " catalogue entries in round " << round;
    link.remove_bus(bus);
    EXPECT_TRUE(eventually([&] {
      return gone_samples.size() == 5 * round && gone_channels.size() == 5 * round;
    })) << gone_samples.size()
        << " samples and " << gone_channels.size() << " entries gone in round " << round;
  }
}

TEST(DdsLink, UnknownInterfaceIsAnErrorAtTheStart) {
  DdsSpec spec = loopback();
  spec.interfaces = {"203.0.113.7"};
  Received received;
  EXPECT_THROW(DdsLink(spec, "test", received.handlers()), DdsError);
}

TEST(DdsLink, PartitionSeparatesStations) {
  const std::string bus = bus_name("partition");
  DdsSpec inside = loopback();
  inside.partition = "plant-a";
  Received received;
  DdsLink link(inside, "test", received.handlers());
  link.add_bus(bus_of(bus, 1));
  link.publish(bus, one_of_each(1), both_clocks());
  Collected<StationSample> seen, unseen;
  Station member(inside, "member"), stranger(loopback(), "stranger");
  stranger.subscribe_samples([&](const StationSample& sample) { unseen.add(sample); });
  member.subscribe_samples([&](const StationSample& sample) { seen.add(sample); });
  EXPECT_TRUE(eventually([&] { return channels_of(seen.all(), bus).size() == 1; }));
  EXPECT_TRUE(channels_of(unseen.all(), bus).empty());
}

}  // namespace
}  // namespace fieldcast::testing
