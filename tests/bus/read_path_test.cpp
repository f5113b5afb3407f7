#include "core/bus/read_path.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/bus/rtu_bus.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using test::kHolding;
using Read = ReadPath::Read;

class ReadPathTest : public testing::Test {
 protected:
  static BusSpec bus() {
    BusSpec bus = test::rtu_bus(1);
    ChannelSpec asked_for;
    asked_for.name = asked_for.at = "on-interest";
    asked_for.range = {kHolding, 200, 1};
    asked_for.on_interest = true;
    bus.devices[0].channels.push_back(asked_for);
    return bus;
  }
  static constexpr ChannelIndex kOnInterest = 4;

  Read next(Instant now, const ReadPath::Gate& gate) {
    auto decision = reads_.next(now, gate);
    EXPECT_TRUE(std::holds_alternative<Read>(decision));
    return std::holds_alternative<Read>(decision) ? std::get<Read>(decision) : Read{};
  }
  Read next(Instant now) { return next(now, at_once_); }
  void answer(const Read& read, const Reply& reply, Instant at) {
    reads_.responded(read.block, reply, at, at, sink_);
  }
  void refuse(const Read& read, Instant at) {
    reads_.failed(read.block, read.longer, Cause::kDeviceError, 2, at, sink_);
  }
  // The device refuses every read that includes this address, until the search has ended.
  void refuse_address(std::uint32_t address) {
    Instant now{};
    for (int i = 0; i < 10; ++i, now += 20ms) {
      auto decision = reads_.next(now, at_once_);
      if (!std::holds_alternative<Read>(decision)) return;
      const Read& read = std::get<Read>(decision);
      const Range& range = read.block.ranges[0];
      if (range.first <= address && address < range.end())
        refuse(read, now);
      else
        answer(read, test::items(Bytes(2 * range.count)), now);
    }
  }
  std::vector<Sample> samples() const {
    std::vector<Sample> all;
    for (const Action& action : actions_) {
      if (const auto* publish = std::get_if<Publish>(&action))
        all.insert(all.end(), publish->samples.begin(), publish->samples.end());
    }
    return all;
  }
  std::vector<std::string> notices() const {
    std::vector<std::string> all;
    for (const Action& action : actions_) {
      if (const auto* notice = std::get_if<Notice>(&action)) all.push_back(notice->text);
    }
    return all;
  }

  BusSetup setup_{bus()};
  ChannelTable channels_{setup_.spec()};
  ReadPath reads_{setup_, channels_};
  ReadPath::Gate at_once_ = [](DeviceIndex, const Request&) { return kLongAgo; };
  std::uint64_t published_ = 0;
  Actions actions_;
  ActionSink sink_{setup_, published_, actions_};
};

TEST_F(ReadPathTest, NeighboursAreReadTogetherAndEachHasItsSample) {
  const Read read = next(Instant{});
  EXPECT_EQ(read.block.ranges, (std::vector<Range>{{kHolding, 100, 4}}));
  EXPECT_FALSE(read.longer);
  answer(read, test::items({0, 1, 0, 2, 0, 3, 0, 4}), Instant{20ms});
  const auto all = samples();
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[2].value, Value{std::uint64_t{3}});
  EXPECT_EQ(all[2].acquired, Instant{20ms});
  EXPECT_EQ(published_, 4u);
  EXPECT_FALSE(reads_.due(Instant{30ms}));
}

TEST_F(ReadPathTest, AFailedReadIsDueAgain) {
  const Read read = next(Instant{});
  reads_.failed(read.block, false, Cause::kChecksum, 0, Instant{20ms}, sink_);
  EXPECT_TRUE(reads_.due(Instant{20ms}));
  EXPECT_TRUE(samples().empty()) << "the refresh is not missed yet";
}

TEST_F(ReadPathTest, ARefusedAddressIsFoundAndTheOthersAreRead) {
  refuse_address(102);
  EXPECT_EQ(notices(), std::vector<std::string>{
                           "holding:102 is refused (02 illegal data address); asked again in 60s"});
  std::size_t good = 0;
  for (const Sample& sample : samples()) {
    if (sample.quality == Quality::kGood)
      ++good;
    else
      EXPECT_EQ(sample.channel, 2u);
  }
  EXPECT_EQ(good, 3u);
  DeviceReport report;
  reads_.describe(0, report);
  EXPECT_EQ(report.refused, std::vector<std::string>{"holding:102"});
}

// One register always brings exception 04, and takes its block along.
TEST_F(ReadPathTest, AnAddressThatIsAlwaysBusyIsFoundAndRequestedAlone) {
  reads_.set_interest(kOnInterest, 100ms, Instant{},
                      sink_);  // a different block, which has a response
  Instant now{};
  std::vector<Instant> alone;
  while (now < Instant{60s}) {
    auto decision = reads_.next(now, at_once_);
    if (const auto* rest = std::get_if<Rest>(&decision)) {
      now = std::max(rest->until, now + 1ms);
      continue;
    }
    const Read& read = std::get<Read>(decision);
    const Range& range = read.block.ranges[0];
    if (range.first <= 102 && 102 < range.end()) {
      if (range.count == 1) alone.push_back(now);
      reads_.failed(read.block, read.longer, Cause::kDeviceBusy, 4, now, sink_);
    } else {
      answer(read, test::items(Bytes(2 * range.count)), now);
    }
    now += 20ms;
  }
  std::map<ChannelIndex, unsigned> good;
  for (const Sample& sample : samples()) good[sample.channel] += sample.quality == Quality::kGood;
  EXPECT_EQ(good[2], 0u);
  for (const ChannelIndex channel : {0u, 1u, 3u}) EXPECT_GT(good[channel], 50u) << channel;
  EXPECT_EQ(notices(), std::vector<std::string>{
                           "holding:102 cannot be read at the moment (04 server device failure), "
                           "others can; it is requested alone, ever more rarely"});
  ASSERT_GE(alone.size(), 5u);
  EXPECT_LE(alone.size(), 15u) << "up to 30 s lie between two requests";

  // It can be read again.
  actions_.clear();
  const Instant until = now + 40s;
  while (now < until) {
    auto decision = reads_.next(now, at_once_);
    if (const auto* rest = std::get_if<Rest>(&decision)) {
      now = std::max(rest->until, now + 1ms);
      continue;
    }
    const Read& read = std::get<Read>(decision);
    answer(read, test::items(Bytes(2 * read.block.ranges[0].count)), now);
    now += 20ms;
  }
  EXPECT_EQ(notices(), std::vector<std::string>{"holding:102 is readable again"});
  Read read = next(now + 2s);
  if (read.block.ranges[0].first == 200) {
    answer(read, test::items({0, 0}), now + 2s);
    read = next(now + 2s);
  }
  EXPECT_EQ(read.block.ranges, (std::vector<Range>{{kHolding, 100, 4}}));
}

TEST_F(ReadPathTest, ADeviceThatIsBusyAsAWholeIsNotSearched) {
  Instant now{};
  unsigned reads = 0;
  while (now < Instant{20s}) {
    auto decision = reads_.next(now, at_once_);
    if (const auto* rest = std::get_if<Rest>(&decision)) {
      now = std::max(rest->until, now + 1ms);
      continue;
    }
    const Read& read = std::get<Read>(decision);
    EXPECT_EQ(read.block.ranges, (std::vector<Range>{{kHolding, 100, 4}}));
    reads_.failed(read.block, read.longer, Cause::kDeviceBusy, 0x0B, now, sink_);
    ++reads;
    now += 20ms;
  }
  EXPECT_GT(reads, 5u);
  EXPECT_TRUE(notices().empty());
  // A probe of one address has a response: the block itself is what the device cannot read.
  reads_.probe_responded(0);
  const Read whole = next(now + 30s);
  reads_.failed(whole.block, whole.longer, Cause::kDeviceBusy, 0x0B, now + 30s, sink_);
  EXPECT_EQ(next(now + 31s).block.ranges[0].count, 2u);
}

// The line may have garbled the request into one that the device refuses.
TEST_F(ReadPathTest, AnAddressThatWasReadIsAskedOnceMoreBeforeItsRefusalIsBelieved) {
  reads_.set_interest(kOnInterest, 100ms, Instant{}, sink_);
  const auto alone = [&](Instant now) {
    for (Read read = next(now);; read = next(now)) {
      if (read.block.ranges[0].first == 200) return read;
      answer(read, test::items(Bytes(2 * read.block.ranges[0].count)), now);
    }
  };
  answer(alone(Instant{}), test::items({0, 7}), Instant{20ms});
  const auto after = [&] {
    std::vector<Quality> all;
    for (const Sample& sample : samples()) {
      if (sample.channel == kOnInterest) all.push_back(sample.quality);
    }
    actions_.clear();
    return all;
  };
  (void)after();
  refuse(alone(Instant{200ms}), Instant{200ms});
  EXPECT_TRUE(after().empty());
  answer(alone(Instant{200ms}), test::items({0, 7}), Instant{220ms});
  EXPECT_EQ(after(), std::vector<Quality>{Quality::kGood});

  refuse(alone(Instant{400ms}), Instant{400ms});
  refuse(alone(Instant{400ms}), Instant{420ms});
  EXPECT_EQ(notices(), std::vector<std::string>{
                           "on-interest is refused (02 illegal data address); asked again in 60s"});
  EXPECT_EQ(after(), std::vector<Quality>{Quality::kBadDeviceError});
}

TEST_F(ReadPathTest, AReadThatWouldHaveToWaitIsMadeLonger) {
  const auto owed_of_four = [](DeviceIndex, const Request& request) {
    return std::get<ReadRequest>(request).ranges[0].count == 4 ? Instant{500ms} : kLongAgo;
  };
  const Read read = next(Instant{}, owed_of_four);
  EXPECT_TRUE(read.longer);
  EXPECT_EQ(std::get<ReadRequest>(read.request).ranges[0].count, 5u);
  EXPECT_EQ(read.block.ranges[0].count, 4u);
  refuse(read, Instant{20ms});
  EXPECT_TRUE(notices().empty()) << "that says nothing of the block";
  EXPECT_TRUE(std::holds_alternative<Rest>(reads_.next(Instant{20ms}, owed_of_four)))
      << "and is not tried again";
}

TEST_F(ReadPathTest, AReadIsMadeLongerOnlyAsFarAsTheDeviceAllows) {
  const auto longer = [](std::uint32_t first, std::optional<std::uint16_t> max_gap) {
    BusSpec spec = test::rtu_bus(1);
    auto& device = spec.devices[0];
    device.max_gap = max_gap;
    device.channels.resize(1);
    device.channels.own()[0].range.first = first;
    const BusSetup setup(spec);
    ChannelTable channels(setup.spec());
    ReadPath reads(setup, channels);
    const auto decision = reads.next(Instant{}, [](DeviceIndex, const Request& request) {
      return std::get<ReadRequest>(request).ranges[0].count == 1 ? Instant{500ms} : kLongAgo;
    });
    return std::holds_alternative<Read>(decision) && std::get<Read>(decision).longer;
  };
  EXPECT_TRUE(longer(100, {}));
  EXPECT_TRUE(longer(100, 1));
  EXPECT_FALSE(longer(100, 0));
  EXPECT_TRUE(longer(65534, {}));
  EXPECT_FALSE(longer(65535, {})) << "the last register of the area";
}

TEST_F(ReadPathTest, AResponseWithoutItsRangesIsReadAgain) {
  answer(next(Instant{}), {}, Instant{20ms});
  for (const Sample& sample : samples()) EXPECT_NE(sample.quality, Quality::kGood);
  refuse_address(0);  // none of these
  std::set<ChannelIndex> good;
  for (const Sample& sample : samples()) {
    if (sample.quality == Quality::kGood) good.insert(sample.channel);
  }
  EXPECT_EQ(good, (std::set<ChannelIndex>{0, 1, 2, 3}));
}

TEST_F(ReadPathTest, ManyChannelsOfABlockAreCounted) {
  const Block block = next(Instant{}).block;
  EXPECT_EQ(reads_.channel_names(block, 2), "r0, r1, +2");
  EXPECT_EQ(reads_.channel_names(block, 4), "r0, r1, r2, r3");
}

TEST_F(ReadPathTest, TheLongestBlockOfAnotherBridgeHolds) {
  DeviceReport learned;
  learned.areas = {{.area = "holding", .longest_block = 2}};
  reads_.inherit(0, learned, Instant{});
  EXPECT_LE(next(Instant{}).block.ranges[0].count, 2u);
}

TEST_F(ReadPathTest, AReportListsABoundedNumberOfRefusedAddresses) {
  BusSpec spec = test::rtu_bus(1);
  auto& channels = spec.devices[0].channels.own();
  channels.resize(ReadPath::kMaxRefusedListed + 6, channels.front());
  DeviceReport learned;
  for (std::uint32_t i = 0; i < channels.size(); ++i) {
    channels[i].range.first = 3 * i;
    channels[i].at = "holding:" + std::to_string(3 * i);
    learned.refused.push_back(channels[i].at);
  }
  const BusSetup setup(spec);
  ChannelTable table(setup.spec());
  ReadPath reads(setup, table);
  reads.inherit(0, learned, Instant{});
  DeviceReport report;
  reads.describe(0, report);
  EXPECT_EQ(report.refused.size(), ReadPath::kMaxRefusedListed);
}

TEST_F(ReadPathTest, AReadThatMustWaitIsHeldBackAndReleased) {
  const auto owed = [](DeviceIndex, const Request&) { return Instant{500ms}; };
  EXPECT_TRUE(std::holds_alternative<Rest>(reads_.next(Instant{}, owed)));
  EXPECT_FALSE(reads_.due(Instant{100ms}));
  reads_.release_held(Instant{100ms}, owed);
  EXPECT_FALSE(reads_.due(Instant{100ms}));
  reads_.release_held(Instant{100ms}, at_once_);
  EXPECT_TRUE(reads_.due(Instant{100ms}));
}

TEST_F(ReadPathTest, AHeldReadIsReleasedWhenItMayBeSent) {
  const auto owed = [](DeviceIndex, const Request&) { return Instant{500ms}; };
  const auto paid = [](DeviceIndex, const Request&) { return Instant{100ms}; };
  EXPECT_TRUE(std::holds_alternative<Rest>(reads_.next(Instant{}, owed)));
  reads_.release_held(Instant{100ms} - 1ns, paid);
  EXPECT_FALSE(reads_.due(Instant{100ms} - 1ns));
  reads_.release_held(Instant{100ms}, paid);
  EXPECT_TRUE(reads_.due(Instant{100ms}));
}

TEST_F(ReadPathTest, AHeldReadIsDueAtTheLatestWhenItsResponseCanNoLongerCome) {
  const auto owed = [](DeviceIndex, const Request&) { return Instant{500ms}; };
  EXPECT_TRUE(std::holds_alternative<Rest>(reads_.next(Instant{}, owed)));
  EXPECT_TRUE(reads_.due(Instant{500ms}));
}

TEST_F(ReadPathTest, TheLongestBlockIsForgottenWithWhatWasLearnedOfTheDevice) {
  for (const AreaIndex area : {AreaIndex{0}, kHolding}) {
    BusSpec spec = test::rtu_bus(1);
    for (ChannelSpec& channel : spec.devices[0].channels) {
      channel.range.area = area;
      channel.encoding.type = area == 0 ? ValueType::kBool : ValueType::kUint16;
    }
    const BusSetup setup(spec);
    ChannelTable channels(setup.spec());
    ReadPath reads(setup, channels);
    const auto longest_read = [&](Instant now, std::uint32_t accepted) {
      std::uint32_t longest = 0;
      for (const Instant end = now + 5s; now < end; now += 20ms) {
        auto decision = reads.next(now, at_once_);
        if (!std::holds_alternative<Read>(decision)) continue;
        const Read& read = std::get<Read>(decision);
        const std::uint32_t count = read.block.ranges[0].count;
        longest = std::max(longest, count);
        if (count > accepted)
          reads.failed(read.block, read.longer, Cause::kDeviceError, 3, now, sink_);
        else
          reads.responded(read.block, test::items(Bytes(2 * count)), now, now, sink_);
      }
      return longest;
    };
    EXPECT_EQ(longest_read(Instant{}, 2), 4u);
    EXPECT_EQ(longest_read(Instant{100s}, 2), 2u) << "the search is over, its result is known";
    reads.forget(0);
    EXPECT_EQ(longest_read(Instant{200s}, 4), 4u);
  }
}

TEST_F(ReadPathTest, ASuspendedDeviceIsNotRead) {
  reads_.suspend(0, kNever);
  EXPECT_FALSE(reads_.due(Instant{}));
  reads_.suspend(0, Instant{1s});
  EXPECT_TRUE(reads_.due(Instant{1s}));
}

TEST_F(ReadPathTest, InterestBringsAChannelInAndItsEndTakesItOut) {
  reads_.set_interest(kOnInterest, 500ms, Instant{}, sink_);
  ASSERT_EQ(actions_.size(), 1u);
  EXPECT_EQ(std::get<Promise>(actions_[0]).gap, Duration{500ms});
  Read read = next(Instant{});
  if (read.block.ranges[0].first != 200) {
    answer(read, test::items(Bytes(2 * read.block.ranges[0].count)), Instant{10ms});
    read = next(Instant{10ms});
  }
  EXPECT_EQ(read.block.ranges[0].first, 200u);
  answer(read, test::items({0, 7}), Instant{20ms});
  actions_.clear();
  reads_.set_interest(kOnInterest, std::nullopt, Instant{1s}, sink_);
  ASSERT_EQ(actions_.size(), 2u);
  EXPECT_EQ(std::get<Publish>(actions_[0]).samples[0].quality, Quality::kUncertain)
      << "before the promise ends";
  EXPECT_FALSE(std::get<Promise>(actions_[1]).gap);
}

// Only the second of two channels on one item is wanted: its priority counts under overload.
TEST(ReadPath, AnItemHasThePriorityOfTheChannelsThatAreWanted) {
  BusSpec bus = test::rtu_bus(1);
  for (ChannelIndex i = 0; i < 4; ++i) {
    ChannelSpec& channel = bus.devices[0].channels[i];
    channel.range.first = i < 2 ? 200 : 600;
    channel.on_interest = true;
    channel.priority = i == 1 ? 10 : 0;
  }
  const BusSetup setup{bus};
  ChannelTable channels{setup.spec()};
  ReadPath reads{setup, channels};
  std::uint64_t published = 0;
  Actions actions;
  ActionSink sink{setup, published, actions};
  for (const ChannelIndex wanted : {1u, 2u}) reads.set_interest(wanted, 20ms, Instant{}, sink);
  const auto draft = reads.draft();
  ASSERT_NE(draft, nullptr);
  draft->make();
  reads.adopt(*draft, Instant{});
  std::map<std::uint32_t, int> count;
  for (Instant now{}; now < Instant{10s};) {
    auto decision = reads.next(now, [](DeviceIndex, const Request&) { return kLongAgo; });
    if (const auto* rest = std::get_if<Rest>(&decision)) {
      now = std::max(rest->until, now + 1us);
      continue;
    }
    const Block& block = std::get<Read>(decision).block;
    ++count[block.ranges[0].first];
    now += 20ms;
    reads.responded(block, test::items(Bytes(2 * block.ranges[0].count)), now, now, sink);
  }
  EXPECT_GT(count[200], count[600] * 3 / 2) << count[600];
}

TEST_F(ReadPathTest, InterestChangesOnlyChannelsThatAreReadForIt) {
  reads_.set_interest(0, 100ms, Instant{}, sink_);
  reads_.set_interest(77, 100ms, Instant{}, sink_);
  EXPECT_TRUE(actions_.empty());
}

TEST_F(ReadPathTest, TheFirstRangeOfADeviceIsItsProbe) {
  EXPECT_EQ(reads_.first_ranges(), (std::vector<std::optional<Range>>{Range{kHolding, 100, 1}}));
}

// Addresses that another bridge reports as refused are not requested.
TEST_F(ReadPathTest, WhatAnotherBridgeHasLearnedIsNotLearnedAgain) {
  DeviceReport learned;
  learned.refused = {"holding:103"};
  reads_.inherit(0, learned, Instant{});
  EXPECT_EQ(next(Instant{}).block.ranges, (std::vector<Range>{{kHolding, 100, 3}}));
  DeviceReport report;
  reads_.describe(0, report);
  EXPECT_EQ(report.refused, learned.refused);
  EXPECT_TRUE(samples().empty());
  channels_.start(Instant{});
  std::vector<Sample> missed;
  channels_.expire(Instant{1min}, missed);
  const auto of_it = std::ranges::find(missed, 3u, &Sample::channel);
  ASSERT_NE(of_it, missed.end());
  EXPECT_EQ(of_it->quality, Quality::kBadDeviceError) << "why it is not read is known";
}

}  // namespace
}  // namespace fieldcast
