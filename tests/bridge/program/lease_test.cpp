// Buses while their devices are programmed: a module that dials in, and a serial line.
#include <termios.h>

#include "bridge/port/serial_line.hpp"
#include "core/program/length_framing.hpp"
#include "tests/bridge/program/program_support.hpp"
#include "tests/bridge/support/modbus_device.hpp"

namespace fieldcast {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::ModbusDevice;
using test::Pty;
using test::RecordingOutlet;
using test::TcpClient;

BusSpec bus_of(const PortSpec& port) {
  BusSpec bus;
  bus.name = "line";
  bus.port = port;
  DeviceSpec device;
  device.name = "plc";
  device.protocol = "modbus-rtu";
  device.timeout = milliseconds{200};
  device.number = "P1";
  ChannelSpec channel;
  channel.name = "r5";
  channel.at = "holding:5";
  channel.range = {2, 5, 1};
  channel.refresh = milliseconds{50};
  channel.access = Access::kReadWrite;
  device.channels.push_back(channel);
  bus.devices.push_back(device);
  return bus;
}

struct Lease : test::ServerFixture {
  // A bus that runs and is known to the server, until the test ends.
  void run(const BusSpec& bus) {
    runner = std::make_shared<BusRunner>(io.context(), io.context(), bus, outlet, &modules);
    runner->start();
    server.add_bus(bus, runner);
    name = bus.name;
  }
  ~Lease() override {
    if (!runner) return;
    server.remove_bus(name);
    runner->stop().wait();
  }
  std::size_t good() {
    const auto record = outlet.record();
    return static_cast<std::size_t>(
        std::count_if(record.samples.begin(), record.samples.end(), [](const Sample& s) { return s.quality == Quality::kGood; }));
  }
  [[nodiscard]] bool hears_more() {
    const std::size_t before = good();
    return outlet.wait_for([&](const auto& r) {
      return static_cast<std::size_t>(std::count_if(r.samples.begin(), r.samples.end(),
                                                    [](const Sample& s) { return s.quality == Quality::kGood; })) >= before + 3;
    });
  }
  [[nodiscard]] bool leased() {
    return outlet.wait_for([](const auto& r) { return !r.samples.empty() && r.samples.back().quality == Quality::kUncertain; });
  }

  IoThread io{"test"};
  RecordingOutlet outlet;
  std::shared_ptr<BusRunner> runner;
  std::string name;
};

SerialPortSpec serial_at(const std::string& path) {
  SerialPortSpec port;
  port.path = path;
  port.line = {115200, 8, Parity::kNone, 1};
  return port;
}

TEST_F(Lease, ASerialBusIsLentAndReadsAgainAtOnce) {
  Pty pty;
  auto device = std::make_unique<ModbusDevice>(pty);
  start();
  run(bus_of(serial_at(pty.path())));
  ASSERT_TRUE(hears_more());
  TcpClient client = engineer();
  device->stop();  // the test is the PLC while it is programmed
  client.say("@@P1FEFF");
  ASSERT_EQ(client.hear("FEFF"), "@@0000FEFF");
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
  ASSERT_TRUE(outlet.wait_for([](const auto& r) { return r.results.size() == 1; }));
  EXPECT_EQ(outlet.record().results[0].cause, Cause::kLeased);

  client.say("@@@00program*\rFEFF");
  const Bytes heard = pty.receive(12);
  EXPECT_EQ(std::string(heard.begin(), heard.end()), "@00program*\r");
  pty.send(program::as_bytes("@00ok*\r"));
  EXPECT_EQ(client.hear("\rFEFF"), "@@@00ok*\rFEFF");

  ModbusDevice again(pty);
  client.say("@@EDFEFF");
  EXPECT_TRUE(hears_more());
}

// Answers reads of one holding register with 5, over the socket of a module, while it lives.
class PlcBehindAModule {
 public:
  explicit PlcBehindAModule(const TcpClient& module) : thread_([this, &module] { serve(module.fd()); }) {}
  ~PlcBehindAModule() {
    over_ = true;
    thread_.join();
  }

 private:
  void serve(int fd) const {
    Bytes heard;
    while (!over_) {
      pollfd wait{fd, POLLIN, 0};
      std::uint8_t piece[64];
      if (::poll(&wait, 1, 5) <= 0) continue;
      const ssize_t count = ::recv(fd, piece, sizeof piece, MSG_DONTWAIT);
      if (count <= 0) continue;
      append(heard, {piece, static_cast<std::size_t>(count)});
      if (heard.size() < 8) continue;
      heard.clear();
      static constexpr std::uint8_t kAnswer[] = {0x01, 0x03, 0x02, 0x00, 0x05, 0x78, 0x47};  // CRC-16/MODBUS 4778, low byte first
      ::send(fd, kAnswer, sizeof kAnswer, MSG_NOSIGNAL);
    }
  }
  std::atomic<bool> over_{false};
  std::thread thread_;
};

TEST_F(Lease, ABusOfAModuleCollectsIsProgrammedAndCollectsAgain) {
  start();
  run(bus_of(DialInPortSpec{"17", std::nullopt}));
  TcpClient module = this->module("17\r\n");
  auto plc = std::make_unique<PlcBehindAModule>(module);
  EXPECT_TRUE(hears_more());
  plc.reset();
  TcpClient client = engineer();
  EXPECT_EQ(pair(client, "17"), "@@0000FEFF");
  EXPECT_TRUE(leased());
  client.say("@@@00program*\rFEFF");
  EXPECT_THAT(module.hear("program*\r"), testing::EndsWith("@00program*\r"));
  module.say("@00ok*\r");
  EXPECT_EQ(client.hear("\rFEFF"), "@@@00ok*\rFEFF");
  plc = std::make_unique<PlcBehindAModule>(module);
  client.say("@@EDFEFF");
  EXPECT_TRUE(hears_more());
}

TEST_F(Lease, AModuleThatIsLostIsCollectedAgainWhenItDialsIn) {
  start();
  run(bus_of(DialInPortSpec{"17", std::nullopt}));
  {
    TcpClient module = this->module("17\r\n");
    PlcBehindAModule plc(module);
    ASSERT_TRUE(hears_more());
  }
  ASSERT_TRUE(outlet.wait_for([](const auto& r) { return r.reports.back().state == BusState::kClosed; }));
  TcpClient module = this->module("17\r\n");
  PlcBehindAModule plc(module);
  EXPECT_TRUE(hears_more());
}

TEST_F(Lease, ASerialPortThatIsUnpluggedIsLostToTheEngineer) {
  Pty pty;
  ModbusDevice device(pty);
  start();
  run(bus_of(serial_at(pty.path())));
  ASSERT_TRUE(hears_more());
  TcpClient client = engineer();
  client.say("@@P1FEFF");
  ASSERT_EQ(client.hear("FEFF"), "@@0000FEFF");
  device.stop();
  pty.unplug();
  EXPECT_EQ(client.hear("FEFF"), "@@0003FEFF");
  EXPECT_TRUE(outlet.wait_for([](const auto& r) { return !r.reports.empty() && r.reports.back().state == BusState::kClosed; }));
}

// The whole bus rests for one device; who asks for its neighbour waits, and the first one keeps the line.
TEST_F(Lease, ABusThatIsLentIsBusyForItsOtherDevices) {
  Pty pty;
  ModbusDevice device(pty);
  start();
  BusSpec bus = bus_of(serial_at(pty.path()));
  bus.devices.push_back(bus.devices.front());
  bus.devices.back().name = "neighbour";
  bus.devices.back().number = "P2";
  run(bus);
  ASSERT_TRUE(hears_more());
  device.stop();
  TcpClient first = engineer(), second = engineer();
  first.say("@@P1FEFF");
  ASSERT_EQ(first.hear("FEFF"), "@@0000FEFF");
  (void)pty.take();
  second.say("@@P2FEFF");
  EXPECT_EQ(second.hear("FEFF"), "@@0002FEFF");
  EXPECT_TRUE(audited("refused: the bus is lent already"));
  first.say("@@@00mine*\rFEFF");
  const Bytes heard = pty.receive(9);
  EXPECT_EQ(std::string(heard.begin(), heard.end()), "@00mine*\r");
  first.say("@@EDFEFF");
  ASSERT_TRUE(audited("stopped by the engineer"));
  second.say("@@P2FEFF");
  EXPECT_EQ(second.hear("FEFF"), "@@0000FEFF");
}

TEST_F(Lease, ABusWhosePortIsClosedIsNotOnline) {
  start();
  run(bus_of(serial_at("/nowhere/at/all")));
  TcpClient client = engineer();
  client.say("@@P1FEFF");
  EXPECT_EQ(client.hear("FEFF"), "@@0001FEFF");
  EXPECT_TRUE(audited("is not open"));
}

TEST_F(Lease, ABusThatStopsIsLostToTheEngineer) {
  Pty pty;
  ModbusDevice device(pty);
  start();
  run(bus_of(serial_at(pty.path())));
  ASSERT_TRUE(hears_more());
  TcpClient client = engineer();
  client.say("@@P1FEFF");
  ASSERT_EQ(client.hear("FEFF"), "@@0000FEFF");
  server.remove_bus(name);
  runner->stop().wait();
  runner.reset();
  EXPECT_EQ(client.hear("FEFF"), "@@0003FEFF");
}

TEST_F(Lease, TheLineTakesTheSpeedThatTheEngineerSetsAndHasItsOwnAgainAfterwards) {
  Pty pty;
  ModbusDevice device(pty);
  start();
  run(bus_of(serial_at(pty.path())));
  ASSERT_TRUE(hears_more());
  TcpClient client = engineer();
  client.say("@@V2P1FEFF");
  ASSERT_EQ(client.hear("FEFF"), "@@0000FEFF");
  const auto becomes = [&](const program::LineSettings& wanted) {
    const auto deadline = std::chrono::steady_clock::now() + seconds{10};
    while (rate_of(pty.master()) != wanted && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
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

// A pseudo-terminal drops data bits and "parity on", but keeps what else the format sets: odd parity, its check, two stop bits.
TEST_F(Lease, TheLineTakesTheFormatThatTheEngineerGivesAndHasItsOwnAgainAfterwards) {
  Pty pty;
  ModbusDevice device(pty);
  start();
  run(bus_of(serial_at(pty.path())));
  ASSERT_TRUE(hears_more());
  TcpClient client = engineer();
  client.say("@@V2P1FEFF");
  ASSERT_EQ(client.hear("FEFF"), "@@0000FEFF");
  const auto becomes = [&](bool wanted) {
    termios now{};
    const auto is = [&] {
      ::tcgetattr(pty.master(), &now);
      return ((now.c_cflag & PARODD) != 0) == wanted && ((now.c_iflag & INPCK) != 0) == wanted;
    };
    for (const auto end = std::chrono::steady_clock::now() + seconds{10}; !is() && std::chrono::steady_clock::now() < end;)
      std::this_thread::yield();
    return is() && rate_of(pty.master()) == program::LineSettings{115200, static_cast<std::uint8_t>(wanted ? 2 : 1)};
  };
  EXPECT_TRUE(becomes(false));
  Bytes settings;
  program::append_settings(settings, {0, 2, 7, Parity::kOdd});  // at the baud rate of the configuration
  client.send(settings);
  EXPECT_TRUE(becomes(true));
  client.close();
  EXPECT_TRUE(becomes(false));
}

}  // namespace
}  // namespace fieldcast
