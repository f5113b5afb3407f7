#include "core/calculate/calculator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <random>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

double sum(std::span<const double> values) {
  double all = 0;
  for (const double each : values) all += each;
  return all;
}

ChannelSpec read(const std::string& name) {
  ChannelSpec channel;
  channel.name = name;
  channel.encoding.type = ValueType::kFloat64;
  return channel;
}

ChannelSpec sum_of(const std::string& name, std::vector<ChannelPath> inputs) {
  ChannelSpec channel = read(name);
  auto calculation = std::make_shared<Calculation>();
  calculation->inputs = std::move(inputs);
  calculation->compile = [] { return Formula(sum); };
  channel.calculation.value = std::move(calculation);
  return channel;
}

ChannelPath own(const std::string& channel) { return {"line", "d", channel}; }

// total = part + c, before its input part = a + b, and far = a + other/d/x.
BusSpec bus() {
  BusSpec spec;
  spec.name = "line";
  spec.devices.emplace_back().name = "d";
  spec.devices[0].channels = {sum_of("total", {own("part"), own("c")}),
                              read("a"),
                              read("b"),
                              sum_of("part", {own("a"), own("b")}),
                              read("c"),
                              sum_of("far", {own("a"), {"other", "d", "x"}})};
  return spec;
}
constexpr ChannelIndex kTotal = 0, kA = 1, kB = 2, kPart = 3, kC = 4, kFar = 5;

Sample sample(ChannelIndex channel, double value, Duration at, Quality quality = Quality::kGood) {
  return {.channel = channel, .value = value, .quality = quality, .acquired = Instant{at}};
}

std::map<ChannelIndex, Calculated> update(Calculator& calculator) {
  std::map<ChannelIndex, Calculated> results;
  calculator.update([&](ChannelIndex channel, const Calculated& result) {
    EXPECT_TRUE(results.emplace(channel, result).second) << "published twice";
  });
  return results;
}

void take(Calculator& calculator, const Sample& one) { calculator.take(std::span(&one, 1)); }

TEST(Calculator, ABusWithoutCalculatedChannelsHasNone) {
  BusSpec spec;
  spec.devices.emplace_back().channels = {read("a")};
  EXPECT_TRUE(Calculator(spec).empty());
  EXPECT_FALSE(Calculator(bus()).empty());
}

TEST(Calculator, AChannelFollowsTheCalculatedChannelsItUses) {
  Calculator calculator(bus());
  const std::vector<Sample> block{sample(kA, 1, 5s), sample(kB, 2, 4s), sample(kC, 3, 6s)};
  calculator.take(block);
  auto results = update(calculator);
  EXPECT_EQ(results.at(kPart).value, Value{3.0});
  EXPECT_EQ(results.at(kTotal).value, Value{6.0});
  EXPECT_EQ(results.at(kTotal).acquired, Instant{4s});
  EXPECT_EQ(results.at(kFar).quality, Quality::kNotYetRead);
}

TEST(Calculator, OnlyChannelsWithANewInputAreEvaluated) {
  Calculator calculator(bus());
  const std::vector<Sample> block{sample(kA, 1, 1s), sample(kB, 2, 1s), sample(kC, 3, 1s)};
  calculator.take(block);
  (void)update(calculator);
  take(calculator, sample(kC, 10, 2s));
  const auto results = update(calculator);
  ASSERT_EQ(results.size(), 1u);
  EXPECT_EQ(results.at(kTotal).value, Value{13.0});
  EXPECT_TRUE(update(calculator).empty());
}

TEST(Calculator, AForeignInputIsFoundByItsIndex) {
  EXPECT_EQ(foreign_inputs(bus()), (std::vector<ChannelPath>{{"other", "d", "x"}}));
  Calculator calculator(bus());
  take(calculator, sample(kA, 1, 1s));
  const InputSample far{0, 41, Quality::kGood, 0, Instant{2s}};
  calculator.take(std::span(&far, 1));
  EXPECT_EQ(update(calculator).at(kFar).value, Value{42.0});
  const InputSample unknown{7, 41, Quality::kGood, 0, Instant{2s}};
  calculator.take(std::span(&unknown, 1));
  EXPECT_TRUE(update(calculator).empty());
}

TEST(Calculator, ABadInputReachesEveryChannelThatDependsOnIt) {
  Calculator calculator(bus());
  const std::vector<Sample> block{sample(kA, 1, 1s), sample(kB, 2, 1s), sample(kC, 3, 1s)};
  calculator.take(block);
  (void)update(calculator);
  take(calculator, sample(kB, 2, 1s, Quality::kBadNoResponse));
  const auto results = update(calculator);
  EXPECT_EQ(results.at(kPart).quality, Quality::kBadNoResponse);
  EXPECT_EQ(results.at(kTotal).quality, Quality::kBadNoResponse);
  EXPECT_FALSE(results.contains(kFar));
}

// Property: the division into blocks and the order of their arrival do not change the last result.
TEST(Calculator, TheLastResultDoesNotDependOnTheOrderOfTheBlocks) {
  std::mt19937 random(11);
  constexpr Quality kSome[]{Quality::kGood,      Quality::kGood,     Quality::kGood,
                            Quality::kUncertain, Quality::kBadFrame, Quality::kBadNoResponse};
  for (int round = 0; round < 500; ++round) {
    std::vector<Sample> last;
    for (const ChannelIndex channel : {kA, kB, kC})
      last.push_back(sample(channel, static_cast<double>(random() % 100),
                            Duration{1 + random() % 1000}, kSome[random() % 6]));
    std::map<ChannelIndex, Calculated> expected;
    for (int way = 0; way < 4; ++way) {
      Calculator calculator(bus());
      std::map<ChannelIndex, Calculated> results;
      // Older samples in any order with the last ones. The last sample of a channel follows its
      // older ones.
      std::vector<Sample> stream;
      for (const Sample& each : last)
        for (std::size_t i = random() % 3; i > 0; --i)
          stream.push_back(
              sample(each.channel, static_cast<double>(random() % 100), 0s, kSome[random() % 6]));
      std::ranges::shuffle(stream, random);
      std::ranges::shuffle(last, random);
      stream.insert(stream.end(), last.begin(), last.end());
      for (std::size_t at = 0; at < stream.size();) {
        const std::size_t count = std::min<std::size_t>(1 + random() % 3, stream.size() - at);
        calculator.take(std::span(stream).subspan(at, count));
        for (auto& [channel, result] : update(calculator)) results[channel] = result;
        at += count;
      }
      if (way == 0) expected = results;
      ASSERT_EQ(results.size(), expected.size());
      for (const auto& [channel, result] : results) {
        EXPECT_EQ(result.quality, expected[channel].quality);
        EXPECT_EQ(result.acquired, expected[channel].acquired);
        if (result.quality == Quality::kGood) { EXPECT_EQ(result.value, expected[channel].value); }
      }
    }
  }
}

}  // namespace
}  // namespace fieldcast
