#include <gtest/gtest.h>

#include <algorithm>

#include "tests/bus/late_storm.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

const StormKind& kind_named(const std::string& name) {
  const auto kinds = storm_kinds();
  return *std::find_if(kinds.begin(), kinds.end(),
                       [&](const StormKind& kind) { return kind.name == name; });
}

// The response arrives after the timeout and is matched to the retry. The response to the retry
// arrives during the next request.
TEST(LateAnswer, BeyondTheTimeoutIsNoAnswerToTheNextRequest) {
  const StormKind& kind = kind_named("modbus-rtu");
  const BusSpec spec = bus_of(kind, "200ms");
  LateStorm storm(kind, spec, faults_of(spec, {.late = 0.05, .by = 250ms}), 1);
  storm.run(20'000);
  const auto counts = storm.counts();
  EXPECT_GT(counts.late, 100u);
  EXPECT_GT(counts.good, 10'000u);
  EXPECT_EQ(counts.wrong, 0u) << counts.first_wrong;
}

// The delay is within the configured timeout, but so rare that the learned timeout is now shorter.
// The retry accepts the response, and its own response arrives during the next request.
TEST(LateAnswer, BeyondWhatWasLearnedIsNoAnswerToTheNextRequest) {
  StormKind kind = kind_named("modbus-rtu");
  kind.devices = 1;  // the next request is to the same unit
  const BusSpec spec = bus_of(kind, "200ms");
  LateStorm storm(kind, spec, faults_of(spec, {.late = 0.003, .by = 150ms}), 1);
  Duration lowest = Duration::max();
  for (int i = 0; i < 400; ++i) {
    storm.run(100);
    const auto report = storm.bus().engine().device_report(0, storm.bus().now());
    lowest = std::min(lowest, report.timeout);
  }
  const auto counts = storm.counts();
  EXPECT_LT(lowest, 100ms) << "it never fell: nothing was tried";
  EXPECT_GT(counts.late, 100u);
  EXPECT_GT(storm.bus().engine().device_report(0, storm.bus().now()).retries, 20u)
      << "no response came after the learned timeout";
  EXPECT_EQ(counts.wrong, 0u) << counts.first_wrong;
}

// Regression: each of these runs published wrong values. A late response was counted twice, so the
// response that was still pending was matched to another request.
struct Seeded {
  std::string kind;
  Duration by;
  std::uint64_t seed;
  friend void PrintTo(const Seeded& of, std::ostream* out) { *out << of.kind << ' ' << of.seed; }
};
class LateResponseTwice : public testing::TestWithParam<Seeded> {};

TEST_P(LateResponseTwice, PaysOnce) {
  const StormKind& kind = kind_named(GetParam().kind);
  const BusSpec spec = bus_of(kind, "200ms");
  const StormFaults faults{.late = 0.05, .by = GetParam().by, .doubled = 0.02, .foreign = 0.2};
  LateStorm storm(kind, spec, faults_of(spec, faults), GetParam().seed);
  storm.run(20'000);
  EXPECT_EQ(storm.counts().wrong, 0u) << storm.counts().first_wrong;
}

INSTANTIATE_TEST_SUITE_P(Storms, LateResponseTwice,
                         testing::Values(Seeded{"modbus-rtu", 560ms, 14}, Seeded{"dtc", 450ms, 13},
                                         Seeded{"modbus-rtu-declared", 450ms, 20}),
                         [](const auto& chosen) {
                           std::string name = chosen.param.kind;
                           std::erase_if(name, [](char c) { return !std::isalnum(c); });
                           return name;
                         });

class LateStorms : public testing::TestWithParam<std::tuple<std::string, int>> {};

TEST_P(LateStorms, PublishNoWrongValueAndStarveNobody) {
  const auto& [name, by] = GetParam();
  const StormKind& kind = kind_named(name);
  const BusSpec spec = bus_of(kind, "200ms");
  StormFaults faults{.late = 0.05, .by = std::chrono::milliseconds{by}, .doubled = 0.02};
  if (kind.foreign) faults.foreign = 0.2;
  LateStorm storm(kind, spec, faults_of(spec, faults), static_cast<std::uint64_t>(by));
  storm.run(5'000);
  const auto counts = storm.counts();
  EXPECT_EQ(counts.wrong, 0u) << counts.first_wrong;
  EXPECT_GT(counts.late, 100u);
  EXPECT_GE(counts.commands, counts.answered);
  EXPECT_LE(counts.commands - counts.answered, 20u) << "commands without a result";
  for (std::size_t c = 0; c < storm.good_of_channels().size(); ++c)
    EXPECT_GT(storm.good_of_channels()[c], 20u) << "channel " << c << " starves";
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const StormKind& kind : storm_kinds()) all.push_back(kind.name);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Protocols, LateStorms,
                         testing::Combine(testing::ValuesIn(names()),
                                          testing::Values(100, 210, 300, 550)),
                         [](const auto& chosen) {
                           std::string name = std::get<0>(chosen.param);
                           std::erase_if(name, [](char c) { return !std::isalnum(c); });
                           return name + std::to_string(std::get<1>(chosen.param));
                         });

}  // namespace
}  // namespace fieldcast::test
