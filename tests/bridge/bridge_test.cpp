// The whole bridge in this process: pseudo-terminals on one side, a DDS station on the other.
#include "bridge/bridge.hpp"

#include <gmock/gmock.h>

#include <condition_variable>
#include <filesystem>
#include <future>
#include <map>

#include "bridge/log/log.hpp"
#include "bridge/station/station.hpp"
#include "bridge/store/event_table.hpp"
#include "bridge/store/store_address.hpp"
#include "tests/bridge/support/claimed_domain.hpp"
#include "tests/bridge/support/modbus_device.hpp"
#include "tests/bridge/support/module_device.hpp"
#include "tests/bridge/support/tcp_client.hpp"

namespace fieldcast {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::ModbusDevice;
using test::Pty;

BusSpec bus_at(const std::string& name, const std::string& path) {
  BusSpec bus;
  bus.name = name;
  SerialPortSpec port;
  port.path = path;
  port.line = {115200, 8, Parity::kNone, 1};
  bus.port = port;
  DeviceSpec device;
  device.name = "plc";
  device.protocol = "modbus-rtu";
  device.timeout = milliseconds{100};
  for (std::uint32_t i = 0; i < 3; ++i) {
    ChannelSpec channel;
    channel.name = "r" + std::to_string(i);
    channel.at = "holding:" + std::to_string(i);
    channel.range = {2, i, 1};
    channel.refresh = milliseconds{100};
    channel.access = Access::kReadWrite;
    device.channels.push_back(channel);
  }
  bus.devices.push_back(device);
  return bus;
}

// What a station receives, waited for with a deadline.
class Receiver {
 public:
  explicit Receiver(const DdsSpec& dds) : station(dds, "receiver") {
    station.subscribe_samples([this](const StationSample& sample) {
      {
        const std::lock_guard lock(mutex_);
        samples_.push_back(sample);
      }
      changed_.notify_all();
    });
  }
  [[nodiscard]] bool receives(const std::function<bool(const StationSample&)>& wanted,
                              milliseconds limit = seconds{15}) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, limit,
                             [&] { return std::any_of(samples_.begin(), samples_.end(), wanted); });
  }
  void forget() {
    const std::lock_guard lock(mutex_);
    samples_.clear();
  }
  [[nodiscard]] std::vector<StationSample> samples() {
    const std::lock_guard lock(mutex_);
    return samples_;
  }
  Station station;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<StationSample> samples_;
};

std::function<bool(const StationSample&)> good_from(const std::string& bus) {
  return [bus](const StationSample& sample) {
    return sample.bus == bus && sample.quality == Quality::kGood;
  };
}

StationCommand write_to(const std::string& bus, const std::string& channel, std::uint64_t value) {
  StationCommand command;
  command.bus = bus;
  command.command.device = "plc";
  command.command.target = ChannelTarget{channel};
  command.command.values = {Value{value}};
  return command;
}

// What the log says from here on, also in a process that has logged before.
class CapturedLog {
 public:
  CapturedLog() {
    testing::internal::CaptureStderr();
    reopen_log();
  }
  ~CapturedLog() {
    if (!ended_) (void)end();
  }
  CapturedLog(const CapturedLog&) = delete;
  CapturedLog& operator=(const CapturedLog&) = delete;

  // Once: what was said.
  [[nodiscard]] std::string end() {
    ended_ = true;
    flush_log(seconds{5});
    std::string said = testing::internal::GetCapturedStderr();
    reopen_log();
    return said;
  }

 private:
  bool ended_ = false;
};

struct BridgeTest : testing::Test {
  BridgeTest() {
    spec.name = "line";
    spec.dds.domain = domain.number();
    spec.buses = {bus_at("one", first.path()), bus_at("two", second.path())};
  }

  test::ClaimedDomain domain;
  BridgeSpec spec;
  Pty first, second;
};

TEST_F(BridgeTest, AStationReceivesEveryBus) {
  ModbusDevice a(first), b(second);
  Receiver receiver(spec.dds);
  Bridge bridge;
  ASSERT_TRUE(bridge.start(spec));
  EXPECT_TRUE(receiver.receives(good_from("one")));
  EXPECT_TRUE(receiver.receives(good_from("two")));
}

TEST_F(BridgeTest, ACommandReachesTheDeviceAndItsResultTheStation) {
  ModbusDevice a(first), b(second);
  Receiver receiver(spec.dds);
  Bridge bridge;
  ASSERT_TRUE(bridge.start(spec));
  ASSERT_TRUE(receiver.receives(good_from("two")));
  const auto result = receiver.station.execute(write_to("two", "r1", 4711), seconds{10});
  ASSERT_TRUE(result) << to_text(result.error());
  EXPECT_EQ(result->state, CommandState::kDone) << result->reason;
  EXPECT_EQ(b.held(1), 4711);
  EXPECT_EQ(b.writes(), 1u);
  EXPECT_EQ(a.writes(), 0u);
}

TEST_F(BridgeTest, WhileADeviceIsProgrammedItsBusRestsAndTheOthersGoOn) {
  ModbusDevice a(first), b(second);
  Receiver receiver(spec.dds);
  std::mutex mutex;
  std::vector<ProgramSessionReport> sessions;
  receiver.station.subscribe_program_sessions([&](const ProgramSessionReport& session) {
    const std::lock_guard lock(mutex);
    sessions.push_back(session);
  });
  const auto session_becomes = [&](ProgramSessionState state) {
    const auto deadline = std::chrono::steady_clock::now() + seconds{15};
    while (std::chrono::steady_clock::now() < deadline) {
      {
        const std::lock_guard lock(mutex);
        if (!sessions.empty() && sessions.back().state == state) return true;
      }
      std::this_thread::yield();
    }
    return false;
  };
  spec.buses[0].devices[0].number = "P1";
  spec.program.engineers.emplace().listen = {"127.0.0.1", test::free_port()};
  Bridge bridge;
  ASSERT_TRUE(bridge.start(spec));
  ASSERT_TRUE(receiver.receives(good_from("one")));
  ASSERT_TRUE(receiver.receives(good_from("two")));

  test::TcpClient engineer(spec.program.engineers->listen.port);
  engineer.send("@@P1FEFF");
  ASSERT_EQ(engineer.receive("FEFF"), "@@0000FEFF");
  EXPECT_TRUE(session_becomes(ProgramSessionState::kOpen));
  EXPECT_TRUE(receiver.receives(
      [](const StationSample& s) { return s.bus == "one" && s.quality == Quality::kUncertain; }));
  const auto refused = receiver.station.execute(write_to("one", "r1", 1), seconds{10});
  ASSERT_TRUE(refused) << to_text(refused.error());
  EXPECT_EQ(refused->cause, "LEASED");
  receiver.forget();
  EXPECT_TRUE(receiver.receives(good_from("two")));
  for (const StationSample& sample : receiver.samples()) EXPECT_NE(sample.bus, "one");

  engineer.send("@@EDFEFF");
  EXPECT_TRUE(receiver.receives(good_from("one")));
  EXPECT_TRUE(session_becomes(ProgramSessionState::kClosed));
  const std::lock_guard lock(mutex);
  EXPECT_EQ(sessions.back().bus + '/' + sessions.back().device, "one/plc");
}

// What the store says of the alarms, in their order: "active", "clear".
std::vector<AlarmRecord> stored_alarms(const std::string& path) {
  std::vector<AlarmRecord> found;
  const auto connection = open_store(StoreAddress(path), IfMissing::kFail);
  EventTable(*connection).alarms({INT64_MIN}, {INT64_MAX}, [&](const AlarmRecord& alarm) {
    found.push_back(alarm);
    return true;
  });
  return found;
}

TEST_F(BridgeTest, AlarmsGoOnAndEndOverRestartsAndReloads) {
  ModbusDevice a(first), b(second);
  Receiver receiver(spec.dds);
  std::mutex mutex;
  std::vector<StationAlarm> received;
  receiver.station.subscribe_alarms([&](const StationAlarm& alarm) {
    const std::lock_guard lock(mutex);
    received.push_back(alarm);
  });
  const auto told = [&](AlarmState state) {
    for (const auto end = std::chrono::steady_clock::now() + seconds{15};
         std::chrono::steady_clock::now() < end; std::this_thread::yield()) {
      const std::lock_guard lock(mutex);
      if (!received.empty() && received.back().state == state) return true;
    }
    return false;
  };
  const auto last = [&] {
    const std::lock_guard lock(mutex);
    return received.back();
  };
  const auto forget = [&] {
    const std::lock_guard lock(mutex);
    received.clear();
  };
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("alarms-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  spec.store = StoreSpec{folder / "plant.db"};
  auto& channel = spec.buses[0].devices[0].channels[2];  // its value is 2
  channel.limits.high = 1;
  UtcTime since;
  {
    Bridge bridge;
    ASSERT_TRUE(bridge.start(spec));
    ASSERT_TRUE(told(AlarmState::kActive));
    since = last().since;
  }
  forget();
  {
    Bridge bridge;  // still beyond: the same alarm
    ASSERT_TRUE(bridge.start(spec));
    ASSERT_TRUE(told(AlarmState::kActive));
    const auto near = [&] {  // the clocks of the two runs differ by what the system corrected
      return std::abs(last().since.nanoseconds - since.nanoseconds) < 20'000'000;
    };
    for (const auto end = std::chrono::steady_clock::now() + seconds{15};
         !near() && std::chrono::steady_clock::now() < end; std::this_thread::yield()) {}
    EXPECT_TRUE(near());
    forget();
    spec.buses[0].devices[0].channels[0].refresh = milliseconds{120};
    ASSERT_TRUE(bridge.reload(spec));
    ASSERT_TRUE(told(AlarmState::kActive));
    EXPECT_TRUE(near());
  }
  EXPECT_EQ(stored_alarms(spec.store->address).size(), 1u);
  forget();
  channel.limits.high = 5;  // while the bridge is down; as if the value had fallen
  {
    Bridge bridge;
    ASSERT_TRUE(bridge.start(spec));
    ASSERT_TRUE(told(AlarmState::kClear));
    channel.limits.high = 1;
    forget();
    ASSERT_TRUE(bridge.reload(spec));
    ASSERT_TRUE(told(AlarmState::kActive));
    channel.limits.high.reset();
    forget();
    ASSERT_TRUE(bridge.reload(spec));
    EXPECT_TRUE(told(AlarmState::kClear));
  }
  std::vector<std::string> states;
  for (const AlarmRecord& alarm : stored_alarms(spec.store->address)) states.push_back(alarm.state);
  EXPECT_THAT(states, testing::ElementsAre("active", "clear", "active", "clear"));
  std::filesystem::remove_all(folder);
}

TEST_F(BridgeTest, AReloadOfABusUnderADownloadWaitsForItsEnd) {
  ModbusDevice a(first), b(second);
  Receiver receiver(spec.dds);
  spec.buses[0].devices[0].number = "P1";
  spec.program.engineers.emplace().listen = {"127.0.0.1", test::free_port()};
  Bridge bridge;
  ASSERT_TRUE(bridge.start(spec));
  ASSERT_TRUE(receiver.receives(good_from("one")));
  test::TcpClient engineer(spec.program.engineers->listen.port);
  engineer.send("@@P1FEFF");
  ASSERT_EQ(engineer.receive("FEFF"), "@@0000FEFF");

  BridgeSpec other = spec;
  other.buses[1].devices[0].channels.pop_back();
  const auto free = bridge.reload(other);  // not the bus that is programmed
  ASSERT_TRUE(free) << free.error();
  EXPECT_THAT(free->waits_for, testing::IsEmpty());
  BridgeSpec wanted = other;
  wanted.buses[0].devices[0].channels.pop_back();
  const auto waiting = bridge.reload(wanted);
  ASSERT_TRUE(waiting) << waiting.error();
  EXPECT_THAT(waiting->waits_for,
              testing::ElementsAre(testing::StartsWith("one/plc by 127.0.0.1:")));
  a.stop();
  (void)first.take();
  engineer.send("@@@00still mine*\rFEFF");
  const Bytes received = first.receive(14);
  EXPECT_EQ(std::string(received.begin(), received.end()), "@00still mine*\r");

  engineer.send("@@EDFEFF");
  ModbusDevice again(first);
  auto done = bridge.reload(wanted);
  for (const auto end = std::chrono::steady_clock::now() + seconds{10};
       done && !done->waits_for.empty() && std::chrono::steady_clock::now() < end;)
    done = bridge.reload(wanted);
  ASSERT_TRUE(done) << done.error();
  EXPECT_THAT(done->waits_for, testing::IsEmpty());
  receiver.forget();
  EXPECT_TRUE(receiver.receives(good_from("one")));
}

TEST_F(BridgeTest, NoReloadLosesAModuleThatIsConnected) {
  ModbusDevice a(first), b(second);
  Receiver receiver(spec.dds);
  spec.program.modules.emplace().listen = {"127.0.0.1", test::free_port()};
  Bridge bridge;
  ASSERT_TRUE(bridge.start(spec));
  test::TcpClient module(spec.program.modules->listen.port);
  module.send("17\n");
  test::ModuleDevice plc(module);
  const auto reload = [&](const char* what) {
    receiver.forget();
    const auto done = bridge.reload(spec);
    EXPECT_TRUE(done) << what << ": " << done.error();
    const bool collected = std::any_of(spec.buses.begin(), spec.buses.end(),
                                       [](const BusSpec& bus) { return bus.name == "far"; });
    if (collected) { EXPECT_TRUE(receiver.receives(good_from("far"))) << what; }
    EXPECT_FALSE(module.is_closed(milliseconds{30})) << what;
  };
  BusSpec far = bus_at("far", "");
  far.port = DialInPortSpec{"17", std::nullopt};
  far.devices[0].channels.resize(1);
  spec.buses.push_back(far);
  reload("its bus is added");
  spec.buses.back().devices[0].channels[0].refresh = milliseconds{120};
  reload("its bus changes");
  spec.program.modules->registration.prefix = "ID=";
  reload("the registration changes");
  spec.name = "other";
  reload("everything starts anew");
  spec.buses.pop_back();
  reload("its bus goes");
  spec.buses.push_back(far);
  reload("its bus comes back");
}

TEST_F(BridgeTest, AReloadOfTheProgrammingPortLeavesTheBusesRunning) {
  ModbusDevice a(first), b(second);
  Receiver receiver(spec.dds);
  Bridge bridge;
  ASSERT_TRUE(bridge.start(spec));
  ASSERT_TRUE(receiver.receives(good_from("one")));
  ASSERT_TRUE(receiver.receives(good_from("two")));
  BridgeSpec wanted = spec;
  wanted.program.engineers.emplace().listen = {"127.0.0.1", test::free_port()};
  ASSERT_TRUE(bridge.reload(wanted));
  test::TcpClient engineer(wanted.program.engineers->listen.port);
  engineer.send("@@P1FEFF");
  EXPECT_EQ(engineer.receive("FEFF"), "@@0001FEFF");
  // A bus that had started anew would count from 1 again.
  const std::uint64_t newest = receiver.samples().back().sequence;
  ASSERT_TRUE(receiver.receives([&](const StationSample& sample) {
    return sample.bus == "one" && sample.sequence > newest + 1;
  }));
  std::map<std::string, std::uint64_t> last;
  for (const StationSample& sample : receiver.samples()) {
    std::uint64_t& before = last[sample.bus + '/' + sample.channel];
    EXPECT_GT(sample.sequence, before) << sample.bus << '/' << sample.channel;
    before = sample.sequence;
  }

  BridgeSpec taken = wanted;
  taken.program.engineers->listen.host = "203.0.113.77";  // of nobody (RFC 5737)
  EXPECT_FALSE(bridge.reload(taken));
  test::TcpClient again(wanted.program.engineers->listen.port);
  again.send("@@P1FEFF");
  EXPECT_EQ(again.receive("FEFF"), "@@0001FEFF");
}

TEST_F(BridgeTest, AChannelOnInterestIsReadOnceAStationIsInterested) {
  ModbusDevice a(first), b(second);
  Receiver receiver(spec.dds);
  spec.buses[0].devices[0].channels[0].on_interest = true;
  Bridge bridge;
  ASSERT_TRUE(bridge.start(spec));
  const auto of_interest = [](const StationSample& s) {
    return s.bus == "one" && s.channel == "r0" && s.quality == Quality::kGood;
  };
  const auto other = [](const StationSample& s) {
    return s.bus == "one" && s.channel == "r1" && s.sequence >= 3;
  };
  ASSERT_TRUE(receiver.receives(other));
  for (const StationSample& sample : receiver.samples()) EXPECT_FALSE(of_interest(sample));
  receiver.station.declare_interest("one/plc/r0", milliseconds{100});
  EXPECT_TRUE(
      receiver.receives([&](const StationSample& s) { return of_interest(s) && s.sequence >= 5; }));
}

TEST_F(BridgeTest, AnInterestInNothingIsToldOnceAndAFloodOfThemHoldsNobodyUp) {
  ModbusDevice a(first), b(second);
  Receiver receiver(spec.dds);
  std::promise<void> renewed;
  receiver.station.subscribe_channels([&, told = false](const StationChannel& channel) mutable {
    if (!told && channel.bus == "one" && channel.channel == "r0" &&
        channel.refresh == milliseconds{50})
      renewed.set_value(), told = true;
  });
  spec.buses[0].devices[0].channels[0].on_interest = true;
  Bridge bridge;
  CapturedLog log;
  ASSERT_TRUE(bridge.start(spec));
  const auto good = [](const StationSample& s) {
    return s.bus == "one" && s.channel == "r0" && s.quality == Quality::kGood;
  };
  receiver.station.declare_interest("one/plc/r0", milliseconds{100});
  EXPECT_TRUE(receiver.receives(good));
  receiver.station.declare_interest("one/plc/r1", milliseconds{100});
  for (int i = 0; i < 3000; ++i)
    receiver.station.declare_interest("nowhere/" + std::to_string(i), milliseconds{100});
  receiver.station.declare_interest(
      "one/plc/r0",
      milliseconds{50});  // interests of one station arrive in order: this is the last
  EXPECT_EQ(renewed.get_future().wait_for(seconds{15}), std::future_status::ready);
  receiver.forget();
  EXPECT_TRUE(receiver.receives(good));
  bridge.stop();
  const std::string said = log.end();
  EXPECT_THAT(said,
              testing::HasSubstr("in one/plc/r1 changes nothing: its channels are read anyway"));
  EXPECT_THAT(said, testing::HasSubstr("are held, at most 4096 of 256"));
  EXPECT_LT(std::count(said.begin(), said.end(), '\n'), 20) << said;
}

// Of a device that falls silent: what the engine counts, what its DataWriters see and what a
// station's DataReader sees.
TEST_F(BridgeTest, MissedRefreshesAreTheSameNumberForTheEngineItsWritersAndAStation) {
  ModbusDevice a(first), b(second);
  spec.buses.pop_back();
  for (ChannelSpec& channel : spec.buses[0].devices[0].channels)
    channel.refresh = milliseconds{300};
  Station station(spec.dds, "strict");
  std::mutex mutex;
  std::condition_variable changed;
  std::map<std::string, StationSample> last;
  std::vector<StationBusStatus> received;
  std::uint64_t requested = 0;
  const auto noted = [&](auto&& change) {
    {
      const std::lock_guard lock(mutex);
      change();
    }
    changed.notify_all();
  };
  const auto reached = [&](auto&& wanted) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, seconds{20}, wanted);
  };
  // The first sample of a channel may reach a station late, when it has joined: a deadline of its
  // own begins then.
  const auto all_good = [&] {
    const auto good = [](const auto& entry) {
      return entry.second.quality == Quality::kGood && entry.second.sequence >= 3;
    };
    return last.size() == 3 && std::ranges::all_of(last, good);
  };
  station.subscribe_samples(
      [&](const StationSample& sample) { noted([&] { last[sample.channel] = sample; }); }, {},
      {milliseconds{300}, [&] { noted([&] { ++requested; }); }});
  station.subscribe_bus_status(
      [&](const StationBusStatus& status) { noted([&] { received.push_back(status); }); });
  Bridge bridge;
  ASSERT_TRUE(bridge.start(spec));
  ASSERT_TRUE(reached(all_good));
  a.set_silent(true);
  ASSERT_TRUE(
      reached([&] { return !received.empty() && received.back().report.deadline_misses >= 24; }));
  a.set_silent(false);
  ASSERT_TRUE(reached(all_good));
  {
    const std::lock_guard lock(mutex);
    received.clear();
  }
  ASSERT_TRUE(reached([&] { return received.size() >= 2; }));
  const std::lock_guard lock(mutex);
  const StationBusStatus& status = received.back();
  // Each end's clock begins when a sample comes to it: a hiccup of the machine between them can
  // hide one round from an end, or show it one more.
  constexpr double kRound = 3;  // channels
  const auto misses = static_cast<double>(status.report.deadline_misses);
  EXPECT_NEAR(static_cast<double>(status.dds_deadline_misses), misses, kRound);
  EXPECT_NEAR(static_cast<double>(requested), misses, 2 * kRound);
  std::uint64_t explained = 0;
  for (const auto& [cause, count] : status.misses) explained += count;
  EXPECT_EQ(explained, status.report.deadline_misses);
  EXPECT_EQ(status.misses.count("LATE"), 0u);
}

TEST_F(BridgeTest, ReloadRestartsOnlyWhatChanged) {
  ModbusDevice a(first), b(second);
  Receiver receiver(spec.dds);
  Bridge bridge;
  ASSERT_TRUE(bridge.start(spec));
  ASSERT_TRUE(receiver.receives(good_from("one")));
  ASSERT_TRUE(receiver.receives(good_from("two")));
  BridgeSpec wanted = spec;
  wanted.buses[1].devices[0].channels[0].name = "renamed";
  ASSERT_TRUE(bridge.reload(wanted));
  EXPECT_TRUE(receiver.receives([](const StationSample& s) {
    return s.bus == "two" && s.channel == "renamed" && s.quality == Quality::kGood;
  }));
  receiver.forget();
  ASSERT_TRUE(receiver.receives(good_from("one")));
  // A bus that was restarted counts its samples from 1 again; this one went on.
  std::map<std::string, std::uint64_t> last;
  for (const StationSample& sample : receiver.samples()) {
    if (sample.bus != "one") continue;
    EXPECT_GT(sample.sequence, 1u);
    EXPECT_GT(sample.sequence, last[sample.channel]);
    last[sample.channel] = sample.sequence;
  }
}

TEST_F(BridgeTest, ARemovedBusIsSilentAndANewOneSpeaks) {
  ModbusDevice a(first), b(second);
  Receiver receiver(spec.dds);
  Bridge bridge;
  BridgeSpec before = spec;
  before.buses.pop_back();
  ASSERT_TRUE(bridge.start(before));
  ASSERT_TRUE(receiver.receives(good_from("one")));
  BridgeSpec after = spec;
  after.buses.erase(after.buses.begin());
  ASSERT_TRUE(bridge.reload(after));
  EXPECT_TRUE(receiver.receives(good_from("two")));
  const unsigned reads = a.reads();
  receiver.forget();
  ASSERT_TRUE(receiver.receives(good_from("two")));
  EXPECT_EQ(a.reads(), reads);
}

TEST_F(BridgeTest, AReloadThatCannotWorkLeavesTheOldOneRunning) {
  ModbusDevice a(first), b(second);
  Receiver receiver(spec.dds);
  Bridge bridge;
  ASSERT_TRUE(bridge.start(spec));
  ASSERT_TRUE(receiver.receives(good_from("one")));
  BridgeSpec wanted = spec;
  wanted.dds.interfaces = {"203.0.113.77"};  // of nobody (RFC 5737)
  EXPECT_FALSE(bridge.reload(wanted));
  receiver.forget();
  EXPECT_TRUE(receiver.receives(good_from("one")));
  EXPECT_TRUE(receiver.receives(good_from("two")));
}

TEST_F(BridgeTest, StoppingAnswersWhatWaitsAndEndsInTime) {
  ModbusDevice a(first), b(second);
  Receiver receiver(spec.dds);
  std::mutex mutex;
  std::map<std::uint64_t, int> results;
  receiver.station.on_result([&](const StationResult& result) {
    const std::lock_guard lock(mutex);
    ++results[result.request_id];
  });
  Bridge bridge;
  ASSERT_TRUE(bridge.start(spec));
  ASSERT_TRUE(receiver.receives(good_from("one")));
  a.set_silent(true);
  constexpr std::size_t kCommands = 20;
  std::vector<std::uint64_t> sent;
  for (std::size_t i = 0; i < kCommands; ++i) {
    const auto id = receiver.station.send(write_to("one", "r0", i), seconds{10});
    ASSERT_TRUE(id) << to_text(id.error());
    sent.push_back(*id);
  }
  // Commands of one writer arrive in order: with the answer to a later one, all of them are in the
  // bridge.
  ASSERT_TRUE(receiver.station.execute(write_to("two", "r0", 1), seconds{10}));
  const auto before = std::chrono::steady_clock::now();
  bridge.stop();
  EXPECT_LT(std::chrono::steady_clock::now() - before,
            seconds{2});  // the promise of the program, not a measurement
  const auto deadline = std::chrono::steady_clock::now() + seconds{5};
  for (;;) {
    {
      const std::lock_guard lock(mutex);
      if (results.size() > kCommands || std::chrono::steady_clock::now() > deadline) break;
    }
    std::this_thread::yield();
  }
  const std::lock_guard lock(mutex);
  for (const std::uint64_t id : sent) EXPECT_EQ(results[id], 1) << "request " << id;
}

TEST_F(BridgeTest, DdsThatCannotBeJoinedIsAnErrorInWords) {
  spec.dds.interfaces = {"203.0.113.77"};
  Bridge bridge;
  const auto started = bridge.start(spec);
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error(), testing::HasSubstr("203.0.113.77"));
}

}  // namespace
}  // namespace fieldcast
