#include "core/calculate/evaluation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

constexpr std::array kQualities{Quality::kGood,
                                Quality::kUncertain,
                                Quality::kBadNoResponse,
                                Quality::kBadFrame,
                                Quality::kBadDeviceError,
                                Quality::kBadRange,
                                Quality::kBadConfiguration,
                                Quality::kNotYetRead};

double product(std::span<const double> values) { return values[0] * values[1]; }

InputState input(double value, Quality quality, Duration at) {
  return {value, quality, 0, Instant{at}};
}

TEST(Evaluation, GoodInputsMakeAGoodResultAsOldAsTheOldest) {
  const std::vector inputs{input(230, Quality::kGood, 5s), input(2, Quality::kGood, 3s)};
  const Calculated result = evaluate(product, inputs, ValueType::kFloat64);
  EXPECT_EQ(result.quality, Quality::kGood);
  EXPECT_EQ(result.value, Value{460.0});
  EXPECT_EQ(result.acquired, Instant{3s});
}

TEST(Evaluation, ABoolResultIsTrueUnlessZero) {
  const std::vector inputs{input(2, Quality::kGood, 1s), input(0, Quality::kGood, 1s)};
  EXPECT_EQ(evaluate(product, inputs, ValueType::kBool).value, Value{false});
  const std::vector both{input(2, Quality::kGood, 1s), input(1, Quality::kGood, 1s)};
  EXPECT_EQ(evaluate(product, both, ValueType::kBool).value, Value{true});
}

TEST(Evaluation, TheWorstInputDecidesAndGivesItsDeviceCode) {
  const std::vector<InputState> inputs{{1, Quality::kUncertain, 0, Instant{1s}},
                                       {1, Quality::kBadDeviceError, 6, Instant{2s}},
                                       {1, Quality::kBadRange, 1, Instant{3s}}};
  const Formula never = [](std::span<const double>) -> double {
    ADD_FAILURE() << "evaluated with a bad input";
    return 0;
  };
  const Calculated result = evaluate(never, inputs, ValueType::kFloat64);
  EXPECT_EQ(result.quality, Quality::kBadDeviceError);
  EXPECT_EQ(result.device_code, 6);
}

TEST(Evaluation, NoFiniteResultIsBadRangeWithItsCode) {
  const std::vector inputs{input(1, Quality::kGood, 1s), input(0, Quality::kGood, 1s)};
  const auto quotient = [](std::span<const double> values) { return values[0] / values[1]; };
  const Calculated result = evaluate(quotient, inputs, ValueType::kFloat64);
  EXPECT_EQ(result.quality, Quality::kBadRange);
  EXPECT_EQ(result.device_code, kNoResultCode);
  EXPECT_EQ(quality_of(cause_of(result)), Quality::kBadRange);
  const std::vector huge{input(1e300, Quality::kGood, 1s), input(1e300, Quality::kGood, 1s)};
  EXPECT_EQ(evaluate(product, huge, ValueType::kFloat64).quality, Quality::kBadRange);
}

TEST(Evaluation, EveryQualityHasItsOwnRankAndACauseOfTheSameQuality) {
  std::vector<int> ranks;
  for (const Quality quality : kQualities) {
    ranks.push_back(badness(quality));
    const bool has_cause = quality != Quality::kGood && quality != Quality::kNotYetRead;
    if (has_cause) { EXPECT_EQ(quality_of(cause_of({.value = {}, .quality = quality})), quality); }
  }
  std::ranges::sort(ranks);
  EXPECT_EQ(std::ranges::adjacent_find(ranks), ranks.end());
  EXPECT_EQ(badness(Quality::kGood), 0);
}

// Property: the quality is the maximum of a total order, so neither the order of the inputs nor a
// repeated input changes it, and one more input never makes it better.
TEST(Evaluation, QualityIsTheMaximumOfTheInputs) {
  std::mt19937 random(7);
  const Formula sum = [](std::span<const double>) { return 1.0; };
  for (int round = 0; round < 2000; ++round) {
    std::vector<InputState> inputs(1 + random() % 6);
    for (InputState& each : inputs)
      each = input(1, kQualities[random() % kQualities.size()], Duration{random() % 1000});
    const Calculated whole = evaluate(sum, inputs, ValueType::kFloat64);
    const auto worst = std::ranges::max_element(
        inputs, {}, [](const InputState& each) { return badness(each.quality); });
    EXPECT_EQ(whole.quality, worst->quality);
    std::vector<InputState> mixed = inputs;
    mixed.push_back(inputs[random() % inputs.size()]);
    std::ranges::shuffle(mixed, random);
    const Calculated again = evaluate(sum, mixed, ValueType::kFloat64);
    EXPECT_EQ(again.quality, whole.quality);
    EXPECT_EQ(again.acquired, whole.acquired);
    mixed.push_back(input(1, kQualities[random() % kQualities.size()], 0s));
    EXPECT_GE(badness(evaluate(sum, mixed, ValueType::kFloat64).quality), badness(whole.quality));
  }
}

TEST(Evaluation, AnInputIsTheNumberOfItsSample) {
  const auto number = [](Value value) { return state_of({.value = std::move(value)}).value; };
  EXPECT_EQ(number(false), 0);
  EXPECT_EQ(number(true), 1);
  EXPECT_EQ(number(std::int64_t{-3}), -3);
  EXPECT_EQ(number(2.5), 2.5);
  EXPECT_EQ(number(std::string("5")), 0);
}

TEST(Evaluation, AnUnknownQualityIsTheWorst) {
  constexpr auto kUnknown = static_cast<Quality>(99);
  for (const Quality other : kQualities) {
    const std::vector inputs{input(1, other, 1s), input(1, kUnknown, 2s)};
    EXPECT_EQ(evaluate(product, inputs, ValueType::kFloat64).quality, kUnknown);
  }
}

}  // namespace
}  // namespace fieldcast
