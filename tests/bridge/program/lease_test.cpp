#include <termios.h>

#include "bridge/capture/bus_capture.hpp"
#include "bridge/port/serial_line.hpp"
#include "core/codec/checksum.hpp"
#include "core/program/frame.hpp"
#include "tests/bridge/program/lease_fixture.hpp"
#include "tests/bridge/support/modbus_device.hpp"
#include "tests/bridge/support/module_device.hpp"

namespace fieldcast::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

using Lease = LeaseFixture;

SerialPortSpec serial_at(const std::string& path) {
  SerialPortSpec port;
  port.path = path;
  port.line = {115200, 8, Parity::kNone, 1};
  return port;
}

TEST_F(Lease, ASerialBusIsLeasedAndReadsAgain) {
  Pty pty;
  auto device = std::make_unique<ModbusDevice>(pty);
  start();
  run(bus_of(serial_at(pty.path())));
  ASSERT_TRUE(receives_more());
  TcpClient client = engineer();
  device->stop();  // the test acts as the PLC
  client.send("@@P1FEFF");
  ASSERT_EQ(client.receive("FEFF"), "@@0000FEFF");
  ASSERT_TRUE(leased());
  (void)pty.take();

  Command command;
  command.requester = "test";
  command.request_id = 1;
  command.device = "plc";
  command.target = ChannelTarget{"r5"};
  command.values = {Value{std::uint64_t{1}}};
  command.expires = kNever;
  ASSERT_TRUE(runner->post(command));
  ASSERT_TRUE(sink.wait_for([](const auto& r) { return r.results.size() == 1; }));
  EXPECT_EQ(sink.record().results[0].cause, Cause::kLeased);

  client.send("@@@00program*\rFEFF");
  const Bytes received = pty.receive(12);
  EXPECT_EQ(std::string(received.begin(), received.end()), "@00program*\r");
  pty.send(program::as_bytes("@00ok*\r"));
  EXPECT_EQ(client.receive("\rFEFF"), "@@@00ok*\rFEFF");

  ModbusDevice again(pty);
  client.send("@@EDFEFF");
  EXPECT_TRUE(receives_more());
}

TEST_F(Lease, ACaptureNamesTheEngineerAndHasTheBytesOfTheSession) {
  Pty pty;
  auto device = std::make_unique<ModbusDevice>(pty);
  start();
  run(bus_of(serial_at(pty.path())));
  const auto tap = std::make_shared<CaptureTap>();
  tap->want(CaptureTap::Wanted::kEverything);
  runner->set_capture(tap);
  ASSERT_TRUE(receives_more());
  TcpClient client = engineer();
  client.send("@@P1FEFF");
  ASSERT_EQ(client.receive("FEFF"), "@@0000FEFF");
  device->stop();  // the test acts as the PLC
  (void)pty.take();
  client.send("@@@00program*\rFEFF");
  ASSERT_EQ(pty.receive(12).size(), 12u);
  std::string remarks, session;
  for (const CaptureRecord& record : tap->take().records) {
    if (record.kind == CaptureRecord::Kind::kRemark) remarks += record.text + '\n';
    if (record.session) session += program::as_text(record.bytes);
  }
  EXPECT_THAT(remarks, testing::HasSubstr("leased to 127.0.0.1:"));
  EXPECT_THAT(remarks, testing::Not(testing::HasSubstr("not captured")));
  EXPECT_EQ(session, "@00program*\r");
}

// All bytes of the client are sent at the pace of the line before the bus sends its first request.
TEST_F(Lease, TheLastBytesOfASlowLineArriveBeforeTheBusReadsAgain) {
  Pty pty;
  auto device = std::make_unique<ModbusDevice>(pty);
  start();
  run(bus_of(serial_at(pty.path())));
  ASSERT_TRUE(receives_more());
  TcpClient client = engineer();
  client.send("@@V2P1FEFF");
  ASSERT_EQ(client.receive("FEFF"), "@@0000FEFF");
  device->stop();  // the test acts as the PLC
  (void)pty.take();
  const Bytes program(96 * 1024, 'p');
  Bytes sent;
  program::append_chunks(sent, program);
  append(sent, program::stop_frame(true));
  client.send(sent);
  ASSERT_TRUE(audited("stopped by the engineer"));
  std::size_t received = 0;
  const auto limit = std::chrono::steady_clock::now() + seconds{60};
  std::size_t foreign = 0;
  for (auto next = std::chrono::steady_clock::now();
       received < program.size() && std::chrono::steady_clock::now() < limit;
       next += milliseconds{100}) {
    std::this_thread::sleep_until(next);  // the pace of the line: about 40 kB/s
    const Bytes piece = pty.take();
    received += static_cast<std::size_t>(std::count(piece.begin(), piece.end(), 'p'));
    if (received < program.size())
      foreign +=
          piece.size() - static_cast<std::size_t>(std::count(piece.begin(), piece.end(), 'p'));
  }
  EXPECT_EQ(received, program.size());
  EXPECT_EQ(foreign, 0u);
  ModbusDevice again(pty);
  EXPECT_TRUE(receives_more());
}

TEST_F(Lease, ALateResponseToTheBusIsNotGivenToTheEngineer) {
  Pty pty;
  auto device = std::make_unique<ModbusDevice>(pty);
  start();
  BusSpec bus = bus_of(serial_at(pty.path()));
  bus.devices.push_back(bus.devices.front());
  bus.devices.back().name = "silent";
  bus.devices.back().number.clear();
  bus.devices.back().link.address = 2;
  for (DeviceSpec& each : bus.devices) {
    each.timeout = milliseconds{300};
    each.retries = 0;
    each.channels.front().refresh = seconds{1};
  }
  run(bus);
  ASSERT_TRUE(sink.wait_for([](const auto& r) {
    const auto found = r.devices.find("silent");
    return found != r.devices.end() && found->second.state == DeviceState::kOffline;
  }));
  TcpClient client = engineer();
  client.send("@@P1FEFF");
  ASSERT_TRUE(leased());
  device->stop();  // the test acts as the PLCs
  (void)pty.take();
  Bytes late{2, 3, 2, 0, 7};
  append_crc16(late, 0);
  pty.send(late);
  ASSERT_EQ(client.receive("FEFF"), "@@0000FEFF");
  client.send("@@@00program*\rFEFF");
  const Bytes received = pty.receive(12);
  EXPECT_EQ(std::string(received.begin(), received.end()), "@00program*\r");
  pty.send(program::as_bytes("@00ok*\r"));
  EXPECT_EQ(client.receive("\rFEFF"), "@@@00ok*\rFEFF");
}

TEST_F(Lease, ASerialPortThatIsUnpluggedIsLostToTheEngineer) {
  Pty pty;
  ModbusDevice device(pty);
  start();
  run(bus_of(serial_at(pty.path())));
  ASSERT_TRUE(receives_more());
  TcpClient client = engineer();
  client.send("@@P1FEFF");
  ASSERT_EQ(client.receive("FEFF"), "@@0000FEFF");
  device.stop();
  pty.unplug();
  EXPECT_EQ(client.receive("FEFF"), "@@0003FEFF");
  EXPECT_TRUE(sink.wait_for([](const auto& r) {
    return !r.reports.empty() && r.reports.back().state == BusState::kClosed;
  }));
}

// The whole bus is leased for one device, so a request for its neighbour is refused.
TEST_F(Lease, ABusThatIsLeasedIsBusyForItsOtherDevices) {
  Pty pty;
  ModbusDevice device(pty);
  start();
  BusSpec bus = bus_of(serial_at(pty.path()));
  bus.devices.push_back(bus.devices.front());
  bus.devices.back().name = "neighbour";
  bus.devices.back().number = "P2";
  run(bus);
  ASSERT_TRUE(receives_more());
  device.stop();
  TcpClient first = engineer(), second = engineer();
  first.send("@@P1FEFF");
  ASSERT_EQ(first.receive("FEFF"), "@@0000FEFF");
  (void)pty.take();
  second.send("@@P2FEFF");
  EXPECT_EQ(second.receive("FEFF"), "@@0002FEFF");
  EXPECT_TRUE(audited("refused: the bus is leased already"));
  first.send("@@@00mine*\rFEFF");
  const Bytes received = pty.receive(9);
  EXPECT_EQ(std::string(received.begin(), received.end()), "@00mine*\r");
  first.send("@@EDFEFF");
  ASSERT_TRUE(audited("stopped by the engineer"));
  second.send("@@P2FEFF");
  EXPECT_EQ(second.receive("FEFF"), "@@0000FEFF");
}

TEST_F(Lease, ABusWhosePortIsClosedIsNotOnline) {
  start();
  run(bus_of(serial_at("/nowhere/at/all")));
  TcpClient client = engineer();
  client.send("@@P1FEFF");
  EXPECT_EQ(client.receive("FEFF"), "@@0001FEFF");
  EXPECT_TRUE(audited("is not open"));
}

TEST_F(Lease, ABusThatStopsIsLostToTheEngineer) {
  Pty pty;
  ModbusDevice device(pty);
  start();
  run(bus_of(serial_at(pty.path())));
  ASSERT_TRUE(receives_more());
  TcpClient client = engineer();
  client.send("@@P1FEFF");
  ASSERT_EQ(client.receive("FEFF"), "@@0000FEFF");
  server.remove_bus(name);
  runner->stop().wait();
  runner.reset();
  EXPECT_EQ(client.receive("FEFF"), "@@0003FEFF");
}

TEST_F(Lease, TheLineTakesTheSpeedThatTheEngineerSetsAndHasItsOwnAgainAfterwards) {
  Pty pty;
  ModbusDevice device(pty);
  start();
  run(bus_of(serial_at(pty.path())));
  ASSERT_TRUE(receives_more());
  TcpClient client = engineer();
  client.send("@@V2P1FEFF");
  ASSERT_EQ(client.receive("FEFF"), "@@0000FEFF");
  const auto becomes = [&](const program::LineSettings& wanted) {
    const auto deadline = std::chrono::steady_clock::now() + seconds{10};
    while (rate_of(pty.master()) != wanted && std::chrono::steady_clock::now() < deadline)
      std::this_thread::yield();
    return rate_of(pty.master()) == wanted;
  };
  EXPECT_TRUE(becomes({115200, 1}));
  Bytes settings;
  program::append_settings(settings, {9600, 2});
  client.send(settings);
  EXPECT_TRUE(becomes({9600, 2}));
  client.close();
  EXPECT_TRUE(becomes({115200, 1}));
}

// A pseudo-terminal ignores data bits and "parity on", but keeps the rest of the format.
TEST_F(Lease, TheLineTakesTheFormatThatTheEngineerGivesAndHasItsOwnAgainAfterwards) {
  Pty pty;
  ModbusDevice device(pty);
  start();
  run(bus_of(serial_at(pty.path())));
  ASSERT_TRUE(receives_more());
  TcpClient client = engineer();
  client.send("@@V2P1FEFF");
  ASSERT_EQ(client.receive("FEFF"), "@@0000FEFF");
  const auto becomes = [&](bool wanted) {
    termios now{};
    const auto is = [&] {
      ::tcgetattr(pty.master(), &now);
      return ((now.c_cflag & PARODD) != 0) == wanted && ((now.c_iflag & INPCK) != 0) == wanted;
    };
    for (const auto end = std::chrono::steady_clock::now() + seconds{10};
         !is() && std::chrono::steady_clock::now() < end;)
      std::this_thread::yield();
    return is() && rate_of(pty.master()) ==
                       program::LineSettings{115200, static_cast<std::uint8_t>(wanted ? 2 : 1)};
  };
  EXPECT_TRUE(becomes(false));
  Bytes settings;
  program::append_settings(settings, {0, 2, 7, Parity::kOdd});  // at the configured baud rate
  client.send(settings);
  EXPECT_TRUE(becomes(true));
  client.close();
  EXPECT_TRUE(becomes(false));
}

using Lease = LeaseFixture;

TEST_F(Lease, ABusOfAModuleCollectsIsProgrammedAndCollectsAgain) {
  start();
  run(bus_of(DialInPortSpec{"17", std::nullopt}));
  TcpClient module = this->module("17\r\n");
  auto plc = std::make_unique<ModuleDevice>(module);
  EXPECT_TRUE(receives_more());
  plc.reset();
  TcpClient client = engineer();
  EXPECT_EQ(pair(client, "17"), "@@0000FEFF");
  EXPECT_TRUE(leased());
  client.send("@@@00program*\rFEFF");
  EXPECT_THAT(module.receive("program*\r"), testing::EndsWith("@00program*\r"));
  module.send("@00ok*\r");
  EXPECT_EQ(client.receive("\rFEFF"), "@@@00ok*\rFEFF");
  plc = std::make_unique<ModuleDevice>(module);
  client.send("@@EDFEFF");
  EXPECT_TRUE(receives_more());
}

TEST_F(Lease, AModuleThatIsLostIsCollectedAgainWhenItDialsIn) {
  start();
  run(bus_of(DialInPortSpec{"17", std::nullopt}));
  {
    TcpClient module = this->module("17\r\n");
    ModuleDevice plc(module);
    ASSERT_TRUE(receives_more());
  }
  ASSERT_TRUE(
      sink.wait_for([](const auto& r) { return r.reports.back().state == BusState::kClosed; }));
  TcpClient module = this->module("17\r\n");
  ModuleDevice plc(module);
  EXPECT_TRUE(receives_more());
}

TEST_F(Lease, AModuleStaysConnectedWhenItsBusRestarts) {
  start();
  BusSpec bus = bus_of(DialInPortSpec{"17", std::nullopt});
  run(bus);
  TcpClient module = this->module("17\r\n");
  ModuleDevice plc(module);
  ASSERT_TRUE(receives_more());
  for (int reload = 0; reload < 20; ++reload) {
    end_bus();
    bus.devices[0].channels[0].refresh += milliseconds{1};
    run(bus);
    ASSERT_TRUE(receives_more()) << reload;
  }
  EXPECT_FALSE(module.is_closed(milliseconds{30}));
}

TEST_F(Lease, AModuleThatDialsInWhileItsBusRestartsIsFound) {
  start();
  BusSpec bus = bus_of(DialInPortSpec{"17", std::nullopt});
  for (int reload = 0; reload < 20; ++reload) {
    run(bus);
    TcpClient module = this->module("17\r\n");
    ModuleDevice plc(module);
    if (reload % 2 == 0) {
      end_bus();
      run(bus);
    }
    ASSERT_TRUE(receives_more()) << reload;
    end_bus();
  }
}

TEST_F(Lease, ABusThatIsAddedFindsItsModule) {
  start();
  TcpClient module = this->module("17\r\n");
  TcpClient client = engineer();
  ASSERT_EQ(pair(client, "17"), "@@0000FEFF");  // present and not used by a bus
  client.send("@@EDFEFF@@nobody1FEFF");
  ASSERT_EQ(client.receive("FEFF"), "@@0001FEFF");
  run(bus_of(DialInPortSpec{"17", std::nullopt}));
  ModuleDevice plc(module);
  EXPECT_TRUE(receives_more());
}

TEST_F(Lease, AModuleUnderProgrammingGoesToItsNewBusAtTheEnd) {
  start();
  TcpClient module = this->module("17\r\n");
  TcpClient client = engineer();
  ASSERT_EQ(pair(client, "17"), "@@0000FEFF");
  run(bus_of(DialInPortSpec{"17", std::nullopt}));
  client.send("@@@00program*\rFEFF");
  EXPECT_EQ(module.receive("\r"), "@00program*\r");
  client.send("@@EDFEFF");
  ModuleDevice plc(module);
  EXPECT_TRUE(receives_more());
}

TEST_F(Lease, AModuleWhoseBusIsRemovedCanBeProgrammedAndFoundAgain) {
  start();
  run(bus_of(DialInPortSpec{"17", std::nullopt}));
  TcpClient module = this->module("17\r\n");
  auto plc = std::make_unique<ModuleDevice>(module);
  ASSERT_TRUE(receives_more());
  end_bus();
  plc.reset();
  TcpClient client = engineer();
  ASSERT_EQ(pair(client, "17"), "@@0000FEFF");
  client.send("@@@00program*\rFEFF");
  EXPECT_THAT(module.receive("program*\r"), testing::EndsWith("@00program*\r"));
  client.send("@@EDFEFF");
  ASSERT_TRUE(audited("stopped by the engineer"));
  run(bus_of(DialInPortSpec{"17", std::nullopt}));
  plc = std::make_unique<ModuleDevice>(module);
  EXPECT_TRUE(receives_more());
}

}  // namespace
}  // namespace fieldcast::test
