#include "bridge/calculate/input_relay.hpp"

#include <gtest/gtest.h>

#include <map>
#include <memory>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

ChannelSpec read(const std::string& name) {
  ChannelSpec channel;
  channel.name = name;
  return channel;
}

ChannelSpec from(const std::string& name, std::vector<ChannelPath> inputs) {
  ChannelSpec channel = read(name);
  auto calculation = std::make_shared<Calculation>();
  calculation->inputs = std::move(inputs);
  channel.calculation.value = std::move(calculation);
  return channel;
}

BusSpec bus(const std::string& name, std::vector<ChannelSpec> channels) {
  BusSpec spec;
  spec.name = name;
  spec.devices.emplace_back().name = "d";
  spec.devices[0].channels = std::move(channels);
  return spec;
}

Sample sample(ChannelIndex channel, double value, Quality quality = Quality::kGood) {
  return {.channel = channel, .value = value, .quality = quality, .acquired = Instant{1s}};
}

// A relay whose buses note what they would run on their thread.
class Relay : public testing::Test {
 protected:
  const BusSpec plain_ = bus("plain", {read("x")});
  const BusSpec source_ = bus("source", {read("a"), read("b"), read("c")});
  const BusSpec sums_ = bus("sums", {from("s", {{"source", "d", "c"}, {"source", "d", "b"}})});
  const std::vector<BusSpec> all_{plain_, source_, sums_};

  void add(const BusSpec& spec) {
    relay_.add(spec, all_,
               {[this, name = spec.name](InputRelay::Fetch fetch) {
                  posted_[name].push_back(std::move(fetch));
                },
                [this, name = spec.name] { ++repeated_[name]; }});
  }
  void publish(const std::string& from, const Sample& one) {
    relay_.publish(from, std::span(&one, 1));
  }

  InputRelay relay_;
  std::map<std::string, std::vector<InputRelay::Fetch>> posted_;
  std::map<std::string, int> repeated_;
};

TEST_F(Relay, ASampleReachesTheBusThatHasItAsInput) {
  add(source_);
  add(sums_);
  publish("source", sample(0, 7));
  EXPECT_TRUE(posted_.empty());
  publish("source", sample(2, 8));
  publish("plain", sample(0, 9));
  ASSERT_EQ(posted_["sums"].size(), 1u);
  const auto got = posted_["sums"][0]();
  ASSERT_EQ(got.size(), 1u);
  EXPECT_EQ(got[0].input, 1u);  // b is 0, c is 1
  EXPECT_EQ(got[0].value, 8);
  EXPECT_EQ(got[0].quality, Quality::kGood);
  EXPECT_EQ(got[0].acquired, Instant{1s});
}

TEST_F(Relay, OfSeveralSamplesTheNewestOfEachInputRemains) {
  add(sums_);
  add(source_);
  for (int i = 0; i < 1000; ++i) publish("source", sample(1, i));
  publish("source", sample(2, 5, Quality::kBadFrame));
  ASSERT_EQ(posted_["sums"].size(), 1u) << "one post until it is fetched";
  const auto got = posted_["sums"][0]();
  ASSERT_EQ(got.size(), 2u);
  EXPECT_EQ(got[0].value, 999);
  EXPECT_EQ(got[1].quality, Quality::kBadFrame);
  publish("source", sample(1, 1));
  EXPECT_EQ(posted_["sums"].size(), 2u);
}

TEST_F(Relay, ASourceRepeatsWhatIsNotGoodForANewReceiver) {
  add(source_);
  EXPECT_EQ(repeated_["source"], 0);
  add(sums_);
  EXPECT_EQ(repeated_["source"], 1);
  add(plain_);
  EXPECT_EQ(repeated_["source"], 1);
  EXPECT_EQ(repeated_["plain"], 0);
}

TEST_F(Relay, InputsOfABusThatEndsAreUncertain) {
  add(source_);
  add(sums_);
  relay_.remove("source");
  ASSERT_EQ(posted_["sums"].size(), 1u);
  for (const InputSample& each : posted_["sums"][0]()) EXPECT_EQ(each.quality, Quality::kUncertain);
  publish("source", sample(2, 8));
  EXPECT_EQ(posted_["sums"].size(), 1u);
}

TEST_F(Relay, AReceiverThatEndedGetsNothing) {
  add(source_);
  add(sums_);
  relay_.remove("sums");
  publish("source", sample(2, 8));
  EXPECT_TRUE(posted_.empty());
}

// A source that returns with another order of its channels.
TEST_F(Relay, AChangedSourceIsRoutedAgain) {
  add(source_);
  add(sums_);
  relay_.remove("source");
  ASSERT_EQ(posted_["sums"].size(), 1u);
  (void)posted_["sums"][0]();
  const BusSpec changed = bus("source", {read("c"), read("a"), read("b")});
  relay_.add(changed, all_, {[](const InputRelay::Fetch&) {}, [] {}});
  publish("source", sample(1, 9));
  EXPECT_EQ(posted_["sums"].size(), 1u) << "a is not an input";
  publish("source", sample(0, 8));
  ASSERT_EQ(posted_["sums"].size(), 2u);
  EXPECT_EQ(posted_["sums"][1]().at(0).input, 1u);
}

}  // namespace
}  // namespace fieldcast
