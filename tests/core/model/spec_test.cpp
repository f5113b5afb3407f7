#include "core/model/spec.hpp"

#include <gtest/gtest.h>

#include <set>

#include "core/model/bus_spec.hpp"
#include "core/model/command.hpp"
#include "core/model/planner_choice.hpp"
#include "core/model/status.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

TEST(OnLoopback, IsAnAddressOrTheNameOfThisMachine) {
  const auto loopback = [](std::string host) {
    ListenSpec listen;
    listen.host = std::move(host);
    return on_loopback(listen);
  };
  for (const char* host : {"127.0.0.1", "127.1.2.3", "::1", "localhost"})
    EXPECT_TRUE(loopback(host)) << host;
  for (const char* host : {"", "0.0.0.0", "::", "10.127.0.1", "1270.0.0.1", "127", "128.0.0.1",
                           "127.example.com", "127.0.0.1.example.com", "localhost.example.com"})
    EXPECT_FALSE(loopback(host)) << host;
}

TEST(Channel, IsReadByItselfUnlessOnRequestOrWriteOnly) {
  ChannelSpec channel;
  channel.refresh = 2s;
  EXPECT_TRUE(read_by_itself(channel));
  EXPECT_EQ(promised_gap(channel), 2s);
  for (const auto& change :
       std::vector<void (*)(ChannelSpec&)>{[](ChannelSpec& c) { c.access = Access::kWriteOnly; },
                                           [](ChannelSpec& c) { c.mode = Mode::kOnDemand; },
                                           [](ChannelSpec& c) { c.on_interest = true; }}) {
    ChannelSpec changed = channel;
    change(changed);
    EXPECT_FALSE(read_by_itself(changed));
    EXPECT_EQ(promised_gap(changed), std::nullopt);
  }
}

TEST(Channel, WithADeadbandPromisesItsHeartbeat) {
  ChannelSpec channel;
  channel.refresh = 2s;
  channel.heartbeat = 10s;
  EXPECT_EQ(promised_gap(channel), 2s) << "a heartbeat needs a deadband";
  channel.deadband = 0.5;
  EXPECT_EQ(promised_gap(channel), 10s);
  channel.heartbeat = 1s;
  EXPECT_EQ(promised_gap(channel), 2s) << "not more often than it is read";
  channel.heartbeat = std::nullopt;
  EXPECT_EQ(promised_gap(channel), 2s);
}

TEST(Channel, IsRequestableIfARequestCanReadIt) {
  ChannelSpec channel;
  channel.mode = Mode::kOnDemand;
  EXPECT_TRUE(is_requestable(channel));
  ChannelSpec unsolicited = channel, write_only = channel;
  unsolicited.unsolicited = true;
  write_only.access = Access::kWriteOnly;
  EXPECT_FALSE(is_requestable(unsolicited));
  EXPECT_FALSE(is_requestable(write_only));
}

TEST(Port, HasItsNameAndItsLine) {
  const LineFormat line{19200, 7, Parity::kEven, 2};
  const PortSpec serial = SerialPortSpec{.path = "/dev/ttyUSB0", .line = line};
  const PortSpec tcp = TcpPortSpec{.host = "10.0.0.7"};
  const PortSpec udp = TcpPortSpec{.host = "10.0.0.7", .port = 9600, .datagrams = true};
  const PortSpec tls = TcpPortSpec{.host = "10.0.0.7", .port = 802, .tls = TlsSpec{}};
  const PortSpec server = Rfc2217PortSpec{.host = "10.0.0.7", .port = 4001, .line = line};
  const PortSpec module = DialInPortSpec{.number = "17"};
  EXPECT_EQ(to_text(serial), "/dev/ttyUSB0 19200 7E2");
  EXPECT_EQ(to_text(tcp), "10.0.0.7:502");
  EXPECT_EQ(to_text(udp), "udp 10.0.0.7:9600");
  EXPECT_EQ(to_text(tls), "tls 10.0.0.7:802");
  EXPECT_EQ(to_text(server), "rfc2217 10.0.0.7:4001 19200 7E2");
  EXPECT_EQ(to_text(module), "dial-in 17");
  EXPECT_EQ(to_text(LineFormat{9600, 8, Parity::kNone, 1}), "9600 8N1");
  EXPECT_EQ(to_text(LineFormat{9600, 8, Parity::kOdd, 1}), "9600 8O1");
  EXPECT_TRUE(has_line(serial));
  EXPECT_FALSE(has_line(tcp));
  EXPECT_EQ(line_of(serial), line);
  EXPECT_EQ(line_of(tcp).baud, 100'000'000u);
  EXPECT_FALSE(over_network(serial));
  EXPECT_TRUE(over_network(module));
  EXPECT_TRUE(has_datagrams(udp));
  EXPECT_FALSE(has_datagrams(tcp));
  EXPECT_TRUE(has_tls(tls));
  for (const PortSpec& port : {udp, serial, server, module}) EXPECT_FALSE(has_tls(port));
}

// The texts are names in configurations and outputs: each value has its own.
template <class Enum>
void expect_own_texts(std::initializer_list<Enum> all) {
  EXPECT_EQ(to_text(static_cast<Enum>(99)), "?");
  std::set<std::string_view> texts{"?"};
  for (const Enum each : all) EXPECT_TRUE(texts.insert(to_text(each)).second) << to_text(each);
}

TEST(Texts, AreDifferent) {
  expect_own_texts({Mode::kIntensive, Mode::kScheduled, Mode::kOnDemand});
  expect_own_texts({Access::kReadOnly, Access::kReadWrite, Access::kWriteOnly});
  expect_own_texts({Fence::kNone, Fence::kListen, Fence::kLock, Fence::kOneClient});
  expect_own_texts({LogLevel::kError, LogLevel::kWarning, LogLevel::kInfo, LogLevel::kDebug});
  expect_own_texts({BusState::kOpening, BusState::kRunning, BusState::kClosed, BusState::kLeased,
                    BusState::kStopped});
  expect_own_texts({AlarmPriority::kLow, AlarmPriority::kMedium, AlarmPriority::kHigh,
                    AlarmPriority::kCritical});
  expect_own_texts({CommandState::kDone, CommandState::kVerified, CommandState::kRejected,
                    CommandState::kFailed, CommandState::kExpired});
  expect_own_texts(
      {ProgramSessionState::kOpen, ProgramSessionState::kClosed, ProgramSessionState::kRefused});
  expect_own_texts({Planner::kCyclic, Planner::kDynamicBlocks, Planner::kFastestMember,
                    Planner::kOnePerChannel});
  expect_own_texts(
      {DeviceState::kUnknown, DeviceState::kOnline, DeviceState::kDegraded, DeviceState::kOffline});
}

TEST(Protocols, ADeviceOfAnUnknownProtocolHasNone) {
  DeviceSpec device;
  device.protocol = "modbus-rtu";
  device.link.address = 1;
  EXPECT_TRUE(make_protocol(device, {}));
  device.protocol = "modbus-plus";
  const auto made = make_protocol(device, {});
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().what, "protocol 'modbus-plus' is unknown");
}

// A reload restarts only what differs.
TEST(Specs, DifferInEachField) {
  const CaptureSpec capture{.folder = "/captures"};
  EXPECT_EQ(capture, (CaptureSpec{.folder = "/captures"}));
  for (const CaptureSpec& other :
       {CaptureSpec{.folder = "/elsewhere"}, CaptureSpec{.folder = "/captures", .file_bytes = 1},
        CaptureSpec{.folder = "/captures", .files = 1},
        CaptureSpec{.folder = "/captures", .only_sessions = true}})
    EXPECT_NE(capture, other);
  const StandbySpec standby{.group = "boiler", .strength = 3};
  EXPECT_EQ(standby, (StandbySpec{.group = "boiler", .strength = 3}));
  EXPECT_NE(standby, (StandbySpec{.group = "boiler", .strength = 4}));
  EXPECT_NE(standby, (StandbySpec{.group = "press", .strength = 3}));
}

TEST(Specs, CalculationsAreComparedByTheirFormulas) {
  const auto shared = [](std::string expression, std::vector<ChannelPath> inputs) {
    auto value = std::make_shared<Calculation>();
    value->expression = std::move(expression);
    value->inputs = std::move(inputs);
    return SharedCalculation{std::move(value)};
  };
  const SharedCalculation sum = shared("a + b", {{}, {}});
  EXPECT_EQ(sum, sum);
  EXPECT_EQ(sum, shared("a + b", {{}, {}}));
  EXPECT_NE(sum, shared("a - b", {{}, {}}));
  EXPECT_NE(sum, shared("a + b", {{}}));
  EXPECT_NE(sum, SharedCalculation{});
  EXPECT_NE(SharedCalculation{}, sum);
}

}  // namespace
}  // namespace fieldcast
