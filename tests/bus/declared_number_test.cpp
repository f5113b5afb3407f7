#include <gtest/gtest.h>

#include "core/bus/command/command_job.hpp"
#include "core/bus/setup/bus_setup.hpp"
#include "tests/bus/virtual_bus.hpp"
#include "tests/support/declared_bus.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using test::VirtualBus;

constexpr auto kGauge = R"(
summary: a gauge that speaks in text
addresses: { from: 1, to: 9 }
areas: [{ name: state, record: true }]
operations:
  - name: read
    read: state
    request: [{ name: start, constant: "R" }, { is: address },
              { is: checksum, kind: xor, of: start..address }]
    answer: &state
      - { name: start, constant: "A" }
      - { is: address }
      - { name: level, is: value, text: 7 }
      - { name: target, is: value, text: "+000.00" }
      - { is: checksum, kind: crc16-modbus, of: start..target, bytes: 2 }
  - name: set
    write: state
    request:
      - { name: start, constant: "W" }
      - { is: address }
      - { name: target, is: value, text: "+000.00" }
      - { is: checksum, kind: crc16-modbus, of: start..target, bytes: 2 }
    answer: *state
)";

BusSpec gauge(const char* declaration = kGauge) {
  const std::string level =
      declaration == kGauge
          ? "          - { name: level, at: level, type: float32, text: decimal }\n"
          : "";
  return test::bus_by(R"(
bridge: b
buses:
  - name: bus
    port: { serial: /dev/ttyS0 }
    protocol: gauge
    defaults: { refresh: 200ms }
    devices:
      - name: d
        address: 1
        allow: [raw-read]
        channels:
)" + level + R"(          - { name: target, at: target, type: float64, access: read-write }
)",
                      "gauge", declaration);
}

CommandResult run(VirtualBus& bus, Command command) {
  command.requester = "test";
  command.device = "d";
  const std::size_t before = bus.results().size();
  bus.command(command);
  bus.run_until(bus.now() + 2s);
  EXPECT_EQ(bus.results().size(), before + 1);
  return bus.results().empty() ? CommandResult{} : bus.results().rbegin()->second.front();
}
CommandResult write(VirtualBus& bus, const Value& value) {
  return run(bus, {.target = ChannelTarget{"target"}, .values = {value}, .verify = true});
}

// A limit of two bytes with its decimals.
constexpr auto kCounter = R"(
summary: a counter
addresses: { from: 1, to: 9 }
areas: [{ name: state, record: true }]
operations:
  - name: read
    read: state
    request: [{ name: start, constant: "R" }, { is: address }]
    answer: &state
      - { name: start, constant: "A" }
      - { is: address }
      - { is: decimals, of: target }
      - { name: target, is: value, bytes: 2, signed: true }
      - { is: checksum, kind: crc16-modbus, of: start..target, bytes: 2 }
  - name: set
    write: state
    request: [{ name: start, constant: "W" }, { is: address }, { is: decimals, of: target },
              { name: target, is: value, bytes: 2, signed: true }]
    answer: *state
)";

TEST(DeclaredNumber, IsWrittenWithItsDecimals) {
  const BusSpec spec = gauge(kCounter);
  VirtualBus bus(spec, {}, 1);
  bus.run_until(bus.now() + 2s);
  for (const double value : {12.5, -0.25, 32767.0, 0.0})
    EXPECT_EQ(write(bus, Value{value}).state, CommandState::kVerified) << value;
  const CommandResult large = write(bus, Value{40000.0});
  EXPECT_EQ(large.cause, Cause::kRange);
  EXPECT_EQ(large.reason, "40000 does not fit the digits that the device accepts");
}

TEST(DeclaredNumber, IsReadAndWrittenAsTheDeviceSpellsIt) {
  const BusSpec spec = gauge();
  VirtualBus bus(spec, {}, 1);
  bus.judge = [](ChannelIndex, const Value& value) {
    const auto* number = std::get_if<double>(&value);
    const bool right = number != nullptr && *number > -100 && *number <= 1000 &&
                       (*number == 0 || std::abs(*number) > 0.001);
    return right ? std::string{} : "no such number is simulated: " + to_text(value);
  };
  bus.run_until(Instant{10s});
  EXPECT_GT(bus.channels()[0].good, 40u);
  EXPECT_EQ(bus.channels()[0].bad, 0u);
  EXPECT_EQ(bus.channels()[1].bad, 0u);

  const auto done = write(bus, Value{-25.5});
  EXPECT_EQ(done.state, CommandState::kVerified) << done.reason;
  EXPECT_EQ(done.values, (std::vector<Value>{-25.5}));
  EXPECT_EQ(bus.channels()[1].value, Value{-25.5});
  const auto rounded = write(bus, Value{1.0 / 3.0});
  EXPECT_EQ(rounded.state, CommandState::kVerified) << rounded.reason;
  EXPECT_EQ(rounded.values, (std::vector<Value>{0.33}));
  const auto large = write(bus, Value{1000.0});
  EXPECT_EQ(large.state, CommandState::kRejected);
  EXPECT_EQ(large.cause, Cause::kRange);
  EXPECT_EQ(large.reason, "1000 does not fit a float64 as text of 7 characters");
}

TEST(DeclaredNumber, IsNeverReadAsBytesByACommandToItsAddress) {
  const BusSpec spec = gauge();
  VirtualBus bus(spec, {}, 1);
  bus.run_until(Instant{1s});
  const auto raw = [&](const std::string& at, const Encoding& encoding) {
    return run(bus, {.target = AddressTarget{at, encoding}, .operation = Operation::kAcquire});
  };
  const auto bytes = raw("level", {.type = ValueType::kFloat32});
  EXPECT_EQ(bytes.state, CommandState::kRejected);
  EXPECT_EQ(
      bytes.reason,
      "type float32 at 'level', which is a text of 7 characters; allowed: string(7), or text: "
      "decimal, decimal-comma, hex or a picture, where it spells a number");
  EXPECT_EQ(raw("level", {.type = ValueType::kString, .string_bytes = 7}).state,
            CommandState::kDone);
  const auto known = raw("target", {.type = ValueType::kFloat64});
  EXPECT_EQ(known.state, CommandState::kDone) << known.reason;
  ASSERT_EQ(known.values.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<double>(known.values[0]));
}

TEST(DeclaredField, IsOneValueAndWrittenOnlyByAnOperationOfItsOwn) {
  BusSpec spec = gauge();
  spec.devices[0].allow_raw_write = true;
  const BusSetup setup(spec);
  const auto reason = [&](const std::string& at, std::vector<Value> values, std::uint32_t count) {
    Command command{.device = "d",
                    .target = AddressTarget{at, {.type = ValueType::kString, .string_bytes = 7}},
                    .values = std::move(values),
                    .count = count};
    if (command.values.empty()) command.operation = Operation::kAcquire;
    const auto job = CommandJob::make(command, setup.device(0), 0, 0, setup.protocol(0));
    return job ? "taken" : job.error().reason;
  };
  EXPECT_EQ(reason("level", {}, 1), "taken");
  EXPECT_EQ(reason("level", {}, 2), "'level' with 2 values reaches beyond the field");
  EXPECT_EQ(reason("level", {std::string("+025.00")}, 0),
            "'level' is read-only: the protocol has no operation that writes it alone");
}

// Its protocol is that of the declaration, not that of the name alone.
TEST(DeclaredField, OfAnAdHocDeviceIsReadByTheSameDeclarationOnly) {
  const BusSetup setup(gauge());
  DeviceSpec other = setup.device(0);
  other.link.address = 2;
  EXPECT_EQ(setup.why_not_ad_hoc(other), std::nullopt);
  other.declaration = gauge(kCounter).devices[0].declaration;
  EXPECT_EQ(setup.why_not_ad_hoc(other), "no device of this bus has the protocol gauge");
  EXPECT_FALSE(only_network_protocols(setup.spec()));
}

}  // namespace
}  // namespace fieldcast
