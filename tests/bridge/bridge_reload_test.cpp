#include <gmock/gmock.h>

#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "bridge/store/event_table.hpp"
#include "bridge/store/sql/sql.hpp"
#include "tests/bridge/support/bridge_fixture.hpp"
#include "tests/bridge/support/modbus_device.hpp"
#include "tests/bridge/support/module_device.hpp"
#include "tests/bridge/support/tcp_client.hpp"

namespace fieldcast::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

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
  Reports<StationAlarm> alarms;
  Receiver receiver(spec.dds);
  receiver.station.subscribe_alarms([&](const StationAlarm& alarm) { alarms.add(alarm); });
  const auto told = [&](AlarmState state) {
    return alarms.newest([&](const StationAlarm& alarm) { return alarm.state == state; });
  };
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("alarms-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  spec.store = StoreSpec{folder / "plant.db"};
  const auto high = [&]() -> std::optional<double>& {
    return spec.buses[0].devices[0].channels[2].limits.high;  // of a channel with the value 2
  };
  high() = 1;
  UtcTime since;
  {
    Bridge bridge;
    ASSERT_TRUE(bridge.start(spec));
    ASSERT_TRUE(told(AlarmState::kActive));
    since = alarms.last().since;
  }
  alarms.forget();
  {
    Bridge bridge;  // still beyond the limit: the same alarm
    ASSERT_TRUE(bridge.start(spec));
    ASSERT_TRUE(told(AlarmState::kActive));
    const auto near = [&](const StationAlarm& alarm) {
      // The clocks of the two runs differ by the system's clock correction.
      return std::abs(alarm.since.nanoseconds - since.nanoseconds) < 20'000'000;
    };
    EXPECT_TRUE(alarms.newest(near));
    alarms.forget();
    spec.buses[0].devices[0].channels[0].refresh = milliseconds{120};
    ASSERT_TRUE(bridge.reload(spec));
    ASSERT_TRUE(told(AlarmState::kActive));
    EXPECT_TRUE(near(alarms.last()));
  }
  EXPECT_EQ(stored_alarms(spec.store->address).size(), 1u);
  alarms.forget();
  high() = 5;  // while the bridge is down; acts as if the value had fallen
  {
    Bridge bridge;
    ASSERT_TRUE(bridge.start(spec));
    ASSERT_TRUE(told(AlarmState::kClear));
    high() = 1;
    alarms.forget();
    ASSERT_TRUE(bridge.reload(spec));
    ASSERT_TRUE(told(AlarmState::kActive));
    high().reset();
    alarms.forget();
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
  spec.program.engineers.emplace().listen = {"127.0.0.1", free_port()};
  Bridge bridge;
  ASSERT_TRUE(bridge.start(spec));
  ASSERT_TRUE(receiver.receives(good_from("one")));
  TcpClient engineer(spec.program.engineers->listen.port);
  engineer.send("@@P1FEFF");
  ASSERT_EQ(engineer.receive("FEFF"), "@@0000FEFF");

  BridgeSpec other = spec;
  other.buses[1].devices[0].channels.own().pop_back();
  const auto free = bridge.reload(other);  // not the bus that is programmed
  ASSERT_TRUE(free) << free.error();
  EXPECT_THAT(free->waits_for, testing::IsEmpty());
  BridgeSpec wanted = other;
  wanted.buses[0].devices[0].channels.own().pop_back();
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
  spec.program.modules.emplace().listen = {"127.0.0.1", free_port()};
  Bridge bridge;
  ASSERT_TRUE(bridge.start(spec));
  TcpClient module(spec.program.modules->listen.port);
  module.send("17\n");
  ModuleDevice plc(module);
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
  reload("all buses are restarted");
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
  wanted.program.engineers.emplace().listen = {"127.0.0.1", free_port()};
  ASSERT_TRUE(bridge.reload(wanted));
  TcpClient engineer(wanted.program.engineers->listen.port);
  engineer.send("@@P1FEFF");
  EXPECT_EQ(engineer.receive("FEFF"), "@@0001FEFF");
  // A restarted bus would count from 1 again.
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
  taken.program.engineers->listen.host = "203.0.113.77";  // unassigned (RFC 5737)
  EXPECT_FALSE(bridge.reload(taken));
  TcpClient again(wanted.program.engineers->listen.port);
  again.send("@@P1FEFF");
  EXPECT_EQ(again.receive("FEFF"), "@@0001FEFF");
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
  // A restarted bus counts its samples from 1; this one must not.
  std::map<std::string, std::uint64_t> last;
  for (const StationSample& sample : receiver.samples()) {
    if (sample.bus != "one") continue;
    EXPECT_GT(sample.sequence, 1u);
    EXPECT_GT(sample.sequence, last[sample.channel]);
    last[sample.channel] = sample.sequence;
  }
}

// Each command ends: done, or rejected because the bus restarts. 64 at a time, so that some arrive
// between the end of the bus and its next start.
TEST_F(BridgeTest, CommandsDuringReloadsEachHaveOneResult) {
  constexpr std::size_t kAtATime = 64;
  ModbusDevice a(first), b(second);
  Receiver receiver(spec.dds);
  std::mutex mutex;
  std::condition_variable changed;
  std::map<std::uint64_t, int> results;
  receiver.station.on_result([&](const StationResult& result) {
    const std::lock_guard lock(mutex);
    ++results[result.request_id];
    EXPECT_TRUE(result.state == CommandState::kDone || result.cause == to_name(Cause::kShutdown))
        << to_text(result);
    changed.notify_all();
  });
  Bridge bridge;
  ASSERT_TRUE(bridge.start(spec));
  ASSERT_TRUE(receiver.receives(good_from("one")));
  std::atomic<bool> reloading = true;
  std::set<std::uint64_t> sent;
  std::thread sender([&] {
    while (reloading) {
      const auto id = receiver.station.send(write_to("one", "r0", 7), seconds{20});
      ASSERT_TRUE(id) << to_text(id.error());
      sent.insert(*id);
      std::unique_lock lock(mutex);
      EXPECT_TRUE(changed.wait_for(lock, seconds{20},
                                   [&] { return results.size() + kAtATime > sent.size(); }));
    }
  });
  for (int refresh = 110; refresh <= 150; refresh += 10) {
    spec.buses[0].devices[0].channels[0].refresh = milliseconds{refresh};
    EXPECT_TRUE(bridge.reload(spec));
  }
  reloading = false;
  sender.join();
  std::unique_lock lock(mutex);
  EXPECT_TRUE(changed.wait_for(lock, seconds{20}, [&] { return results.size() == sent.size(); }))
      << sent.size() - results.size() << " of " << sent.size() << " have no result";
  for (const auto& [id, count] : results) EXPECT_EQ(count, 1) << "request " << id;
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
  wanted.dds.interfaces = {"203.0.113.77"};  // unassigned (RFC 5737)
  EXPECT_FALSE(bridge.reload(wanted));
  receiver.forget();
  EXPECT_TRUE(receiver.receives(good_from("one")));
  EXPECT_TRUE(receiver.receives(good_from("two")));
}

}  // namespace
}  // namespace fieldcast::test
