// Tests the samples that a station receives from the remaining bridge after a network cut. The test
// simulates a member on the other side.
#include <gtest/gtest.h>

#include <atomic>
#include <utility>

#include "bridge/dds/endpoints/standby_channel.hpp"
#include "bridge/dds/receivers/taker.hpp"
#include "bridge/dds/topics/block.hpp"
#include "tests/bridge/standby/takeover_fixture.hpp"

namespace fieldcast {
namespace {

using namespace takeover;

class Third {
 public:
  explicit Third(std::uint32_t domain) : outside_(Watch::spec(domain), "third", nullptr) {
    told_.group = "g";
    told_.member.bridge = "third";
    told_.member.since = 1;
    told_.member.not_ready = "it only knows of another master";
  }
  ~Third() { stop_writing(); }

  void tell(StandbyTerm term) {
    told_.member.term = term;
    ++told_.member.beat;
    channel_.tell(told_);
  }
  void write(std::uint64_t sequence) {
    if (blocks_ == nullptr) blocks_ = outside_.writer(kSampleBlockTopic, "third");
    if (epoch_ == 0) return;
    idl::SampleBlock block;
    block.bus() = "one";
    block.epoch(epoch_);
    block.number(1'000'000);
    BlockFiller filler(block, 1'300);
    LastValue value;
    value.kind = idl::ValueKind::VALUE_UINT64;
    value.quality = idl::Quality::GOOD;
    value.acquired_at = 1;
    value.sequence = sequence;
    for (const ChannelIndex channel : {0, 1}) (void)filler.add(channel, value);
    filler.finish();
    blocks_->write(&block);
  }
  void stop_writing() {
    if (blocks_ != nullptr) outside_.remove(std::exchange(blocks_, nullptr));
    if (reader_ != nullptr) outside_.remove(std::exchange(reader_, nullptr));
  }

 private:
  static StandbyChannelHandlers nobody() {
    return {[](const auto&) {}, [](const auto&) {}, [](const auto&) {}, [](const auto&) {}};
  }

  Domain outside_;
  StandbyChannel channel_{outside_, "third", "g", UtcTime{1}, nobody()};
  StandbyMessage told_;
  std::atomic<std::uint64_t> epoch_{0};
  Taker<idl::SampleBlock> taker_{[this](const idl::SampleBlock& block, const dds::SampleInfo&) {
    if (block.number() != 1'000'000) epoch_ = block.epoch();
  }};
  dds::DataReader* reader_ =
      outside_.reader(kSampleBlockTopic, &taker_, dds::StatusMask::data_available());
  dds::DataWriter* blocks_ = nullptr;
};

// After the cut, a term without a master is reported; its master published higher numbers.
TEST_F(TakeoverTest, AMasterThatRemainsAfterACutCountsAboveTheOneThatLeft) {
  start_both();
  Third third(domain.number());
  const StandbyTerm term = StandbyTerm{7} << 32 | 1;
  EXPECT_TRUE(within([&] {
    third.tell(term);
    return watch.sequence_of("count") > sequences_of(term) &&
           watch.sequence_of("level") > sequences_of(term);
  }));
  EXPECT_TRUE(says("a", "remains master of group g, term 8"));
  expect_samples();
  write(17);
  EXPECT_TRUE(within([&] { return watch.results().size() == 1; }));
  EXPECT_EQ(watch.last_results().begin()->second.state, CommandState::kDone);
  EXPECT_EQ(watch.fault(), "");
  expect_one_master();
}

// A master unknown to the present one has left; only the station has its count.
TEST_F(TakeoverTest, AMasterCountsAboveOneThatOnlyStationsHaveHeard) {
  start_both();
  Third third(domain.number());
  third.tell(0);
  const std::uint64_t sequence = sequences_of(StandbyTerm{7} << 32) + 1;
  EXPECT_TRUE(within([&] {
    third.write(sequence);
    return watch.sequence_of("count") == sequence && watch.sequence_of("level") == sequence;
  }));
  third.stop_writing();
  EXPECT_TRUE(within([&] {
    return watch.sequence_of("count") > sequence && watch.sequence_of("level") > sequence;
  }));
  EXPECT_TRUE(says("a", "remains master of group g"));
  expect_samples();
  EXPECT_EQ(watch.fault(), "");
  expect_one_master();
}

}  // namespace
}  // namespace fieldcast
