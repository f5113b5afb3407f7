// Checks that two bridges on one wire, without any other connection, do not garble a frame.
//
// FIELDCAST_SHARED_WIRE_SEEDS sets the number of seeds; the default is 1.
#include "tests/bus/shared_wire.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/bus/late_storm.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

std::uint64_t seeds() {
  const char* text = std::getenv("FIELDCAST_SHARED_WIRE_SEEDS");
  return text == nullptr ? 1 : std::strtoull(text, nullptr, 10);
}

std::vector<StormKind> kinds_of_lines() {
  std::vector<StormKind> kinds;
  for (const StormKind& kind : storm_kinds()) {
    // Full duplex of DF1 is a line between two stations.
    if (kind.port.starts_with("{ serial") && kind.name != "allen-bradley-df1")
      kinds.push_back(kind);
  }
  return kinds;
}

BusSpec fenced(const StormKind& kind, const std::string& timeout = "200ms") {
  BusSpec spec = bus_of(kind, timeout);
  std::get<SerialPortSpec>(spec.port).fence.kind = Fence::kListen;
  return spec;
}

struct Chance {
  explicit Chance(std::uint64_t seed) : random(seed) {}
  Duration up_to(Duration most) {
    return Duration{static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(most.count()))};
  }
  std::vector<Adapter> adapters() {
    std::vector<Adapter> two(2);
    for (Adapter& each : two) {
      each.latency = random() % 2 ? Duration{16ms} : up_to(2ms);
      each.echo = random() % 3 == 0;
    }
    return two;
  }
  std::mt19937_64 random;
};

class SharedLine : public testing::TestWithParam<StormKind> {
 protected:
  const BusSpec spec_ = fenced(GetParam());
  const FenceTimes times_ = fence_times(spec_);
};

TEST_P(SharedLine, ASecondMasterThatBelievesToBeAloneStaysSilentForThirtySeconds) {
  for (std::uint64_t seed = 1; seed <= seeds(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Chance chance(seed);
    SharedWire wire(spec_, chance.adapters(), {}, seed);
    wire.open(0);
    wire.run_until(Instant{3s + chance.up_to(2s)});
    wire.open(1);
    wire.run_until(wire.now() + 30s);
    EXPECT_EQ(wire.counts().garbled, 0u);
    EXPECT_EQ(wire.master(1).frames, 0u);
    EXPECT_EQ(wire.master(1).engine.bus_report(wire.now()).foreign_masters, 1u);
    EXPECT_TRUE(wire.master(1).engine.bus_report(wire.now()).listening);
    EXPECT_EQ(wire.master(0).engine.bus_report(wire.now()).foreign_masters, 0u);
    EXPECT_GT(wire.master(0).good, 100u);
    wire.close(0);
    const Instant died = wire.now();
    wire.run_until(died + 3s);
    EXPECT_GT(wire.master(1).frames, 0u) << "takes the wire over";
    EXPECT_GE(wire.counts().shortest_turn, times_.listen);
    EXPECT_LE(wire.master(1).first_frame - died, times_.listen + 2 * times_.slot + 300ms);
    EXPECT_EQ(wire.counts().garbled, 0u);
  }
}

TEST_P(SharedLine, OneThatWasStoppedDoesNotSendIntoTheOther) {
  for (std::uint64_t seed = 1; seed <= seeds(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Chance chance(seed);
    SharedWire wire(spec_, chance.adapters(), {}, seed);
    wire.open(0);
    wire.run_until(Instant{2s + chance.up_to(1s)});
    wire.open(1);
    for (int turn = 0; turn < 5; ++turn) {
      wire.run_until(wire.now() + 3s + chance.up_to(1s));
      wire.stop(turn % 2, chance.up_to(2s));
    }
    wire.run_until(wire.now() + 3s);
    EXPECT_EQ(wire.counts().garbled, 0u);
  }
}

TEST_P(SharedLine, OfTwoThatBeginTogetherOneGoesOn) {
  for (std::uint64_t seed = 1; seed <= seeds(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Chance chance(seed);
    SharedWire wire(spec_, chance.adapters(), {}, seed);
    wire.open(0);
    wire.run_until(Instant{seed % 4 == 0 ? Duration{} : chance.up_to(60ms)});
    wire.open(1);
    wire.run_until(Instant{5s});
    const std::uint64_t garbled = wire.counts().garbled;
    EXPECT_LE(garbled, 6u);
    const std::uint64_t before = wire.counts().turns;
    wire.run_until(Instant{15s});
    EXPECT_EQ(wire.counts().garbled, garbled) << "later than the beginning";
    EXPECT_EQ(wire.counts().turns, before);
    EXPECT_GT(wire.master(0).good + wire.master(1).good, 50u);
  }
}

TEST_P(SharedLine, NoiseAndLateResponsesMakeNobodySendIntoAnother) {
  for (std::uint64_t seed = 1; seed <= seeds(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Chance chance(seed);
    SharedWire wire(spec_, chance.adapters(), {.noise = 1, .late = 0.02}, seed);
    wire.open(0);
    wire.run_until(Instant{4s + chance.up_to(1s)});
    wire.open(1);
    wire.run_until(wire.now() + 20s);
    // A bridge with lost devices or a late response is silent, so the second one may start.
    if (wire.counts().turns > 0) { EXPECT_GE(wire.counts().shortest_turn, times_.listen); }
  }
}

// A disconnected master listens before each request. After it is reconnected, one yields.
TEST_P(SharedLine, OfTwoWhoseCableIsPluggedInAgainOneGivesWay) {
  std::uint64_t garbled = 0;
  for (std::uint64_t seed = 1; seed <= seeds(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Chance chance(seed);
    SharedWire wire(spec_, chance.adapters(), {}, seed);
    wire.open(0);
    wire.run_until(Instant{2s + chance.up_to(1s)});
    wire.open(1);
    wire.run_until(wire.now() + 3s);
    wire.cut(0, true);
    wire.run_until(wire.now() + 15s + chance.up_to(5s));
    EXPECT_GT(wire.master(1).good, 20u) << "the other one took the wire";
    wire.cut(0, false);
    wire.run_until(wire.now() + 10s);
    // Usually none; a request may be pending when the cable is reconnected.
    EXPECT_LE(wire.counts().garbled, 8u);
    garbled += wire.counts().garbled;
    const auto listening = [&](std::size_t master) {
      return wire.master(master).engine.bus_report(wire.now()).listening;
    };
    EXPECT_NE(listening(0), listening(1)) << "one of them goes on";
  }
  RecordProperty("garbled", std::to_string(garbled));
}

std::uint64_t requests_of(const BusSpec& spec) {
  SharedWire wire(spec, {Adapter{}}, {}, 1);
  wire.open(0);
  while (wire.master(0).frames == 0) wire.run_until(wire.now() + 1ms);
  wire.run_until(wire.master(0).first_frame + 30s);
  return wire.master(0).frames;
}

TEST_P(SharedLine, TheFenceCostsABusThatIsNeverIdleNothing) {
  BusSpec fenced = spec_;
  for (DeviceSpec& device : fenced.devices)
    for (ChannelSpec& channel : device.channels) channel.mode = Mode::kIntensive;
  BusSpec open = fenced;
  std::get<SerialPortSpec>(open.port).fence = {};
  const std::uint64_t with = requests_of(fenced), without = requests_of(open);
  EXPECT_EQ(with, without);
  RecordProperty("with", std::to_string(with));
}

INSTANTIATE_TEST_SUITE_P(Bus, SharedLine, testing::ValuesIn(kinds_of_lines()),
                         [](const auto& kind) {
                           std::string name = kind.param.name;
                           std::replace_if(
                               name.begin(), name.end(),
                               [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); },
                               '_');
                           return name;
                         });

}  // namespace
}  // namespace fieldcast::test
