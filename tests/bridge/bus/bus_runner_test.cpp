#include "bridge/bus/bus_runner.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <future>
#include <optional>

#include "bridge/base/clock.hpp"
#include "bridge/base/io_thread.hpp"
#include "tests/bridge/support/modbus_device.hpp"
#include "tests/bridge/support/recording_sink.hpp"
#include "tests/bridge/support/tcp_device.hpp"

namespace fieldcast::test {
namespace {

using std::chrono::milliseconds;
using Record = RecordingSink::Record;

constexpr std::uint16_t kFirstRegister = 100;

BusSpec bus_at(const std::string& path, unsigned channels = 4) {
  BusSpec bus;
  bus.name = "bench";
  SerialPortSpec port;
  port.path = path;
  port.line = {115200, 8, Parity::kNone, 1};
  bus.port = port;
  DeviceSpec device;
  device.name = "plc";
  device.protocol = "modbus-rtu";
  device.timeout = milliseconds{100};
  for (unsigned i = 0; i < channels; ++i) {
    ChannelSpec channel;
    channel.name = "r" + std::to_string(i);
    channel.at = "holding:" + std::to_string(kFirstRegister + i);
    channel.range = {2, kFirstRegister + i, 1};
    channel.refresh = milliseconds{50};
    channel.access = Access::kReadWrite;
    device.channels.push_back(channel);
  }
  bus.devices.push_back(device);
  return bus;
}

Command write_command(std::uint64_t id, const std::string& channel, std::uint64_t value) {
  Command command;
  command.requester = "test";
  command.request_id = id;
  command.device = "plc";
  command.target = ChannelTarget{channel};
  command.values = {Value{value}};
  return command;
}

std::size_t good_samples(const Record& record) {
  return static_cast<std::size_t>(
      std::count_if(record.samples.begin(), record.samples.end(),
                    [](const Sample& s) { return s.quality == Quality::kGood; }));
}

struct BusRunnerTest : testing::Test {
  void TearDown() override {
    if (runner) stop();
  }
  void begin(const BusSpec& spec) {
    runner = std::make_unique<BusRunner>(io, io.context(), spec, sink);
    runner->start();
  }
  void stop() {
    ASSERT_EQ(runner->stop().wait_for(std::chrono::seconds{5}), std::future_status::ready);
    runner.reset();
  }

  Pty pty;
  RecordingSink sink;
  IoThread io{"bus"};
  std::unique_ptr<BusRunner> runner;
};

TEST_F(BusRunnerTest, ItsPlanIsReportedWithoutBeingAskedFor) {
  begin(bus_at(pty.path()));
  ASSERT_TRUE(sink.wait_for([](const Record& r) { return !r.plans.empty(); }));
  const PlanReport plan = sink.record().plans.front();
  ASSERT_EQ(plan.groups.size(), 1U);
  EXPECT_EQ(plan.groups[0].device, "plc");
  std::vector<std::string> channels;
  for (const PlanReport::Point& point : plan.groups[0].points) {
    EXPECT_EQ(point.area, "holding");
    EXPECT_LE(point.worst_gap, milliseconds{50});
    channels.insert(channels.end(), point.channels.begin(), point.channels.end());
  }
  EXPECT_THAT(channels, testing::ElementsAre("r0", "r1", "r2", "r3"));
}

TEST_F(BusRunnerTest, PublishesTheRegistersOfADevice) {
  ModbusDevice device(pty);
  begin(bus_at(pty.path()));
  ASSERT_TRUE(sink.wait_for([](const Record& r) { return good_samples(r) >= 8; }));
  stop();
  for (const Sample& sample : sink.record().samples) {
    if (sample.quality != Quality::kGood) continue;
    EXPECT_EQ(std::get<std::uint64_t>(sample.value), kFirstRegister + sample.channel);
  }
}

TEST_F(BusRunnerTest, AcquiredIsStampedInUtc) {
  const auto wall = [] {
    return std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch())
        .count();
  };
  const std::int64_t before = wall();
  ModbusDevice device(pty);
  begin(bus_at(pty.path()));
  ASSERT_TRUE(sink.wait_for([](const Record& r) { return good_samples(r) >= 1; }));
  stop();
  const Record record = sink.record();
  for (std::size_t i = 0; i < record.samples.size(); ++i) {
    if (record.samples[i].quality != Quality::kGood) continue;
    EXPECT_GE(record.acquired[i].nanoseconds, before - 1'000'000);
    EXPECT_LE(record.acquired[i].nanoseconds, wall() + 1'000'000);
  }
}

// One probe at a time; each ends once, also when the bus stops.
TEST_F(BusRunnerTest, AProbeEndsOnce) {
  ModbusDevice device(pty);
  BusSpec bus = bus_at(pty.path());
  for (ChannelSpec& channel : bus.devices.front().channels) channel.refresh = milliseconds{500};
  begin(bus);
  ASSERT_TRUE(sink.wait_for([](const Record& r) { return good_samples(r) >= 4; }));
  DeviceSpec silent = bus.devices.front();
  silent.link.address = 2;
  using Results = std::vector<ProbedDevice>;
  const auto probe = [&](const DeviceSpec& spec) {
    auto ended = std::make_shared<std::promise<Results>>();
    const Instant limit = steady_now() + std::chrono::seconds{30};
    EXPECT_TRUE(runner->probe(DeviceProbe({spec}, limit),
                              [ended](const Results& devices, const UtcMapping&) {
                                ended->set_value(devices);  // throws if it is called twice
                              }));
    return ended->get_future();
  };
  const Results first = probe(silent).get();
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first.front().channels.size(), DeviceProbe::kMostSilent);
  EXPECT_EQ(first.front().channels.front().cause, Cause::kNoResponse);
  silent.timeout = std::chrono::seconds{20};  // it waits for free time
  auto waiting = probe(silent);
  EXPECT_TRUE(probe(silent).get().empty());
  stop();
  EXPECT_EQ(waiting.get().front().channels.front().cause, Cause::kShutdown);
  EXPECT_TRUE(sink.record().results.empty()) << "they are not results of commands";
}

TEST_F(BusRunnerTest, AWriteReachesTheDeviceOnceAndEndsInOneResult) {
  ModbusDevice device(pty);
  begin(bus_at(pty.path()));
  ASSERT_TRUE(sink.wait_for([](const Record& r) { return good_samples(r) >= 1; }));
  ASSERT_TRUE(runner->post(write_command(7, "r2", 4711)));
  ASSERT_TRUE(sink.wait_for([](const Record& r) { return !r.results.empty(); }));
  EXPECT_EQ(device.held(kFirstRegister + 2), 4711);
  EXPECT_EQ(device.writes(), 1u);
  stop();
  const Record record = sink.record();
  ASSERT_EQ(record.results.size(), 1u);
  EXPECT_EQ(record.results[0].request_id, 7u);
  EXPECT_EQ(record.results[0].state, CommandState::kDone) << record.results[0].reason;
}

TEST_F(BusRunnerTest, StartsWithoutItsPortAndFindsItLater) {
  const std::string link =
      testing::TempDir() + "fieldcast-runner-test-" + std::to_string(::getpid());
  ::unlink(link.c_str());
  begin(bus_at(link));
  ASSERT_TRUE(sink.wait_for([](const Record& r) {
    return !r.reports.empty() && r.reports.back().state == BusState::kClosed;
  }));
  ModbusDevice device(pty);
  ASSERT_EQ(::symlink(pty.path().c_str(), link.c_str()), 0);
  EXPECT_TRUE(sink.wait_for([](const Record& r) { return good_samples(r) >= 4; }));
  ::unlink(link.c_str());
}

TEST_F(BusRunnerTest, ComesBackAfterItsAdapterWasUnplugged) {
  const std::string link =
      testing::TempDir() + "fieldcast-replug-test-" + std::to_string(::getpid());
  ::unlink(link.c_str());
  Pty second;
  {
    ModbusDevice device(pty);
    ASSERT_EQ(::symlink(pty.path().c_str(), link.c_str()), 0);
    begin(bus_at(link));
    ASSERT_TRUE(sink.wait_for([](const Record& r) { return good_samples(r) >= 4; }));
  }
  ::unlink(link.c_str());
  pty.unplug();
  ASSERT_TRUE(sink.wait_for([](const Record& r) {
    return std::any_of(r.reports.begin(), r.reports.end(),
                       [](const BusReport& b) { return b.state == BusState::kClosed; });
  }));
  const std::size_t before = good_samples(sink.record());
  ModbusDevice device(second);
  ASSERT_EQ(::symlink(second.path().c_str(), link.c_str()), 0);
  EXPECT_TRUE(sink.wait_for([&](const Record& r) { return good_samples(r) >= before + 4; }));
  ::unlink(link.c_str());
}

TEST_F(BusRunnerTest, ADeadDeviceIsBadAndNeverGood) {
  ModbusDevice device(pty);
  device.set_silent(true);
  begin(bus_at(pty.path()));
  ASSERT_TRUE(sink.wait_for([](const Record& r) {
    return std::any_of(r.samples.begin(), r.samples.end(),
                       [](const Sample& s) { return s.quality == Quality::kBadNoResponse; });
  }));
  stop();
  EXPECT_EQ(good_samples(sink.record()), 0u);
}

TEST_F(BusRunnerTest, StoppingRespondsToEveryCommandThatWaits) {
  ModbusDevice device(pty);
  device.set_silent(true);  // the first command hangs and blocks the others
  begin(bus_at(pty.path()));
  constexpr std::uint64_t kCommands = 50;
  for (std::uint64_t id = 1; id <= kCommands; ++id)
    ASSERT_TRUE(runner->post(write_command(id, "r0", id)));
  stop();
  std::vector<std::uint64_t> answered;
  for (const CommandResult& result : sink.record().results) answered.push_back(result.request_id);
  std::sort(answered.begin(), answered.end());
  ASSERT_EQ(answered.size(), kCommands);
  for (std::uint64_t id = 1; id <= kCommands; ++id) EXPECT_EQ(answered[id - 1], id);
}

TEST_F(BusRunnerTest, NothingIsPublishedAfterStop) {
  ModbusDevice device(pty);
  begin(bus_at(pty.path()));
  ASSERT_TRUE(sink.wait_for([](const Record& r) { return good_samples(r) >= 1; }));
  stop();
  const std::size_t published = sink.record().samples.size();
  EXPECT_FALSE(sink.wait_for([&](const Record& r) { return r.samples.size() > published; },
                             milliseconds{100}));
  EXPECT_EQ(sink.record().reports.back().state, BusState::kStopped);
}

TEST_F(BusRunnerTest, AFloodOfCommandsIsBounded) {
  ModbusDevice device(pty);
  begin(bus_at(pty.path()));
  std::size_t taken = 0, refused = 0;
  for (std::uint64_t id = 1; id <= 20'000; ++id)
    (runner->post(write_command(id, "r1", id % 1000)) ? taken : refused) += 1;
  EXPECT_EQ(taken + refused, 20'000u);
  stop();
  EXPECT_EQ(sink.record().results.size(), taken);
}

TEST_F(BusRunnerTest, ReportsOnceASecondAndAtChanges) {
  ModbusDevice device(pty);
  begin(bus_at(pty.path()));
  ASSERT_TRUE(sink.wait_for([](const Record& r) {
    return r.reports.size() >= 3 && r.reports.back().state == BusState::kRunning &&
           r.devices.contains("plc") && r.devices.find("plc")->second.state == DeviceState::kOnline;
  }));
}

// The path is a link in a directory that disappears with the adapter, like /dev/serial/by-id.
TEST_F(BusRunnerTest, AnAdapterThatIsPluggedInAgainIsReadWithinASecond) {
  const auto folder = std::filesystem::path(testing::TempDir()) /
                      ("fieldcast-replug-" + std::to_string(::getpid()));
  const auto plug_in = [&](const Pty& adapter) {
    std::filesystem::create_directories(folder);
    std::filesystem::create_symlink(adapter.path(), folder / "usb-FTDI");
  };
  const auto goods_after = [](const Record& r, std::size_t first) {
    return std::any_of(r.samples.begin() + static_cast<std::ptrdiff_t>(first), r.samples.end(),
                       [](const Sample& s) { return s.quality == Quality::kGood; });
  };
  std::optional<ModbusDevice> device(pty);
  plug_in(pty);
  begin(bus_at(folder / "usb-FTDI"));
  ASSERT_TRUE(sink.wait_for([](const Record& r) { return good_samples(r) >= 4; }));
  device.reset();
  pty.unplug();
  std::filesystem::remove_all(folder);
  const auto closed_for = [](const Record& r, int reports) {
    return std::count_if(r.reports.begin(), r.reports.end(), [](const BusReport& report) {
             return report.state == BusState::kClosed;
           }) >= reports;
  };
  // The next attempt is more than a second later: 0.1, 0.3, 0.7, 1.5, 3.1 and 6.3 s.
  ASSERT_TRUE(sink.wait_for([&](const Record& r) { return closed_for(r, 5); }));

  const std::size_t before = sink.record().samples.size();
  const Pty again;
  const ModbusDevice other(again);
  plug_in(again);
  EXPECT_TRUE(
      sink.wait_for([&](const Record& r) { return goods_after(r, before); }, milliseconds{1000}));
  stop();
  std::filesystem::remove_all(folder);
}

// The back-off after each connection would be 0.1, 0.2, 0.4, 0.8, 1.6, 3.2 and 6.4 s.
TEST_F(BusRunnerTest, AConnectionThatCarriedAResponseIsOpenedAgainWithoutDelay) {
  TcpDevice device;
  device.close_after_answers();
  BusSpec bus = bus_at("");
  bus.port = TcpPortSpec{.host = "127.0.0.1", .port = device.port()};
  bus.devices.front().protocol = "modbus-tcp";
  begin(bus);
  EXPECT_TRUE(sink.wait_for([](const Record& r) { return good_samples(r) >= 32; },
                            std::chrono::seconds{10}))
      << "four samples of each connection";
}

// Register 0xCEC2 holds its own number, which is a character in GBK.
TEST_F(BusRunnerTest, TextsOfTheDeviceComeAndGoInItsCharacterSet) {
  ModbusDevice device(pty);
  BusSpec spec = bus_at(pty.path(), 1);
  ChannelSpec& channel = spec.devices[0].channels[0];
  channel.range.first = 0xCEC2;
  channel.encoding = {.type = ValueType::kString, .string_bytes = 2, .charset = Charset::kGbk};
  begin(spec);
  const auto shows = [&](const std::string& text) {
    return sink.wait_for([&](const Record& record) {
      return std::any_of(record.samples.begin(), record.samples.end(), [&](const Sample& sample) {
        return sample.quality == Quality::kGood && sample.value == Value{text};
      });
    });
  };
  EXPECT_TRUE(shows("温"));
  Command command = write_command(1, "r0", 0);
  command.values = {std::string("度")};
  ASSERT_TRUE(runner->post(command));
  EXPECT_TRUE(shows("度"));
  EXPECT_EQ(device.held(0xCEC2), 0xB6C8);
  command.request_id = 2;
  command.values = {std::string("ü😀")};
  ASSERT_TRUE(runner->post(command));
  ASSERT_TRUE(sink.wait_for([](const Record& record) { return record.results.size() == 2; }));
  EXPECT_EQ(sink.record().results[0].state, CommandState::kDone);
  EXPECT_EQ(sink.record().results[1].state, CommandState::kRejected);
}

}  // namespace
}  // namespace fieldcast::test
