#include "bridge/station/bus_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>

namespace fieldcast {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class Bus {
 public:
  explicit Bus(std::uint64_t epoch) : epoch_(epoch) {}

  idl::CatalogueBlock catalogue(std::uint32_t channels, std::uint32_t first = 0) const {
    idl::CatalogueBlock block;
    block.bus() = "bus";
    block.epoch(epoch_);
    block.first(first);
    block.channels(channels);
    for (std::uint32_t i = first; i < std::min(channels, first + 64); ++i) {
      auto& entry = block.entries().emplace_back();
      entry.device() = "d";
      entry.channel() = "c" + std::to_string(i);
    }
    return block;
  }
  // Returns a block with this sequence number, also as the value, for each channel.
  idl::SampleBlock samples(std::vector<ChannelIndex> channels, std::uint64_t sequence) {
    idl::SampleBlock block;
    block.bus() = "bus";
    block.epoch(epoch_);
    block.number(++number_);
    BlockFiller filler(block, 32'000);
    LastValue value{.kind = idl::ValueKind::VALUE_UINT64,
                    .quality = idl::Quality::GOOD,
                    .device_code = 0,
                    .bits = sequence,
                    .acquired_at = 1,
                    .sequence = sequence,
                    .text = {}};
    for (const ChannelIndex channel : channels) (void)filler.add(channel, value);
    filler.finish();
    return block;
  }
  idl::SampleBlock snapshot(std::vector<ChannelIndex> channels, std::uint64_t sequence) {
    idl::SampleBlock block = samples(std::move(channels), sequence);
    block.snapshot(true);
    return block;
  }
  void lose_one() { ++number_; }

 private:
  std::uint64_t epoch_;
  std::uint64_t number_ = 0;
};

class BusTableTest : public ::testing::Test {
 protected:
  void on(const idl::CatalogueBlock& block) { table.on_catalogue(block, handlers); }
  void on(const idl::SampleBlock& block) { table.on_samples(block, handlers); }
  std::vector<std::string> said() { return std::exchange(lines, {}); }

  BusTable table;
  std::vector<std::string> lines;
  BusTable::Handlers handlers{
      [this](const StationChannel& channel) { lines.push_back("+" + channel.channel); },
      [this](const StationSample& sample) {
        lines.push_back(sample.channel + "#" + std::to_string(sample.sequence));
      },
      [this](const StationSample& last) { lines.push_back("-" + last.channel); }};
  Bus bus{100};
};

TEST(BusTableMemory, IsReturnedWithTheLastChannel) {
  constexpr std::uint32_t kChannels = 20'000;
  const auto in_use = [] {
    const auto info = ::mallinfo2();
    return info.uordblks + info.hblkhd;
  };
  BusTable table;
  const Bus bus(100);
  const std::size_t before = in_use();
  for (std::uint32_t first = 0; first < kChannels; first += 64)
    table.on_catalogue(bus.catalogue(kChannels, first), {});
  for (std::uint32_t first = 0; first < kChannels; first += 64)
    table.on_catalogue_gone(100, first, {});
  EXPECT_FALSE(table.is_known());
  EXPECT_LT(in_use(), before + 100'000);
}

TEST_F(BusTableTest, SamplesHaveTheNamesOfTheCatalogue) {
  on(bus.catalogue(2));
  on(bus.samples({1, 0}, 1));
  EXPECT_THAT(said(), ElementsAre("+c0", "+c1", "c1#1", "c0#1"));
}

TEST_F(BusTableTest, SamplesHaveTheEpochOfTheirBlock) {
  std::uint64_t epoch = 0;
  handlers.sample = [&epoch](const StationSample& sample) { epoch = sample.epoch; };
  on(bus.catalogue(1));
  on(bus.samples({0}, 1));
  EXPECT_EQ(epoch, 100u);
}

TEST_F(BusTableTest, ValuesWaitForTheirNames) {
  on(bus.snapshot({0, 64}, 3));
  on(bus.samples({64}, 4));
  EXPECT_THAT(said(), IsEmpty());
  on(bus.catalogue(65, 64));
  EXPECT_THAT(said(), ElementsAre("+c64", "c64#4"));
}

TEST_F(BusTableTest, WhatIsKnownAlreadyIsNotReportedAgain) {
  on(bus.catalogue(2));
  on(bus.samples({0, 1}, 5));
  (void)said();
  on(bus.snapshot({0, 1}, 5));
  on(bus.samples({0}, 4));
  on(bus.catalogue(2));
  EXPECT_THAT(said(), IsEmpty());
}

TEST_F(BusTableTest, AChangedEntryIsReportedAlone) {
  on(bus.catalogue(3));
  (void)said();
  idl::CatalogueBlock changed = bus.catalogue(3);
  changed.entries()[1].refresh(7);
  on(changed);
  EXPECT_THAT(said(), ElementsAre("+c1"));
}

TEST_F(BusTableTest, AHoleWantsASnapshotUntilOneComes) {
  on(bus.catalogue(1));
  EXPECT_TRUE(table.wants_snapshot()) << "none came yet";
  on(bus.snapshot({0}, 1));
  EXPECT_FALSE(table.wants_snapshot());
  on(bus.samples({0}, 2));
  bus.lose_one();
  on(bus.samples({0}, 4));
  EXPECT_TRUE(table.wants_snapshot());
  EXPECT_EQ(table.missing(), 1u);
  on(bus.snapshot({0}, 4));
  EXPECT_FALSE(table.wants_snapshot());
}

TEST_F(BusTableTest, AHoleThatTheSnapshotShowsIsClosedByIt) {
  on(bus.catalogue(1));
  on(bus.samples({0}, 1));
  bus.lose_one();
  on(bus.snapshot({0}, 2));
  EXPECT_FALSE(table.wants_snapshot());
  EXPECT_EQ(table.missing(), 1u);
}

TEST_F(BusTableTest, WhoseSamplesCountBelowThoseOfBeforeIsBehindUntilTheyCountOn) {
  on(bus.catalogue(2));
  on(bus.samples({0, 1}, 500));
  on(bus.samples({0}, 10));
  EXPECT_FALSE(table.is_behind()) << "one of a master that was replaced may come late";
  on(bus.samples({0}, 11));
  EXPECT_TRUE(table.is_behind());
  on(bus.samples({0}, 501));
  EXPECT_FALSE(table.is_behind());
  on(bus.snapshot({1}, 10));
  on(bus.samples({1}, 11));
  EXPECT_TRUE(table.is_behind());
  on(bus.samples({0}, 502));
  EXPECT_TRUE(table.is_behind()) << "the other channel is still ignored";
  on(Bus(200).catalogue(2));
  EXPECT_FALSE(table.is_behind()) << "it starts again";
}

TEST_F(BusTableTest, ABusThatRestartsBeginsAgain) {
  on(bus.catalogue(1));
  on(bus.snapshot({0}, 9));
  (void)said();
  Bus anew(101);
  on(anew.catalogue(1));
  on(anew.samples({0}, 1));
  EXPECT_THAT(said(), ElementsAre("-c0", "+c0", "c0#1"));
  EXPECT_TRUE(table.wants_snapshot());
  on(bus.samples({0}, 10));
  table.on_catalogue_gone(100, 0, handlers);
  EXPECT_THAT(said(), IsEmpty()) << "the epoch before is over";
}

// A second master steps back before its catalogue has arrived.
TEST_F(BusTableTest, SamplesAloneDoNotEndAnEpochThatHasACatalogue) {
  on(bus.catalogue(1));
  on(bus.snapshot({0}, 9));
  (void)said();
  Bus later(101);
  on(later.snapshot({0}, 1));
  on(bus.samples({0}, 10));
  EXPECT_THAT(said(), ElementsAre("c0#10"));
  on(later.catalogue(1));
  EXPECT_THAT(said(), ElementsAre("-c0", "+c0"));
  EXPECT_TRUE(table.wants_snapshot());
}

TEST_F(BusTableTest, WithItsCatalogueABusIsRemovedAndMayComeBackWithALowerEpoch) {
  on(bus.catalogue(65));
  on(bus.catalogue(65, 64));
  (void)said();
  table.on_catalogue_gone(100, 64, handlers);
  EXPECT_THAT(said(), ElementsAre("-c64"));
  table.on_catalogue_gone(100, 0, handlers);
  EXPECT_EQ(said().size(), 64u);
  EXPECT_FALSE(table.is_known());
  Bus behind(50);
  on(behind.catalogue(1));
  EXPECT_THAT(said(), ElementsAre("+c0"));
}

TEST_F(BusTableTest, BlocksThatDoNotFitAreRefused) {
  idl::CatalogueBlock beyond = bus.catalogue(2);
  beyond.channels(1);
  on(beyond);
  beyond.channels(4'000'000'000u);
  on(beyond);
  idl::SampleBlock far = bus.samples({0}, 1);
  far.channels()[0] = 4'000'000'000u;
  on(far);
  far.kinds().clear();
  on(far);
  EXPECT_THAT(said(), IsEmpty());
}

TEST_F(BusTableTest, WhoBeginsLateIsNotifiedOfWhatIsKnown) {
  on(bus.catalogue(2));
  on(bus.samples({1}, 1));
  (void)said();
  table.replay(handlers);
  EXPECT_THAT(said(), ElementsAre("+c0", "+c1", "c1#1"));
}

}  // namespace
}  // namespace fieldcast
