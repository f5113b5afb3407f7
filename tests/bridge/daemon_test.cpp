// fieldcast-bridge as its user sees it: a process with signals, lines of a log and an exit code.
#include <gmock/gmock.h>
#include <signal.h>

#include <filesystem>
#include <fstream>

#include "bridge/exit_code.hpp"
#include "tests/bridge/support/claimed_domain.hpp"
#include "tests/bridge/support/modbus_device.hpp"
#include "tests/bridge/support/process.hpp"

namespace fieldcast {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::AllOf;
using testing::HasSubstr;

struct Process : test::Process {
  explicit Process(const std::vector<std::string>& arguments) : test::Process(FIELDCAST_BRIDGE, arguments) {}
};

struct DaemonTest : testing::Test {
  DaemonTest() {
    folder = std::filesystem::path(testing::TempDir()) /
             ("fieldcast-daemon-" + std::to_string(::getpid()) + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder);
    file = folder / "plant.yaml";
    write("holding:0");
  }
  ~DaemonTest() override { std::filesystem::remove_all(folder); }

  // Bus one at the pseudo-terminal, bus two at a port that does not exist, whose channel lies at `at`.
  void write(const std::string& at, const std::string& interface = "127.0.0.1") const {
    std::ofstream(file) << "bridge: test\n"
                        << "dds: { domain: " << domain.number() << ", interfaces: [" << interface << "] }\n"
                        << "buses:\n"
                        << bus("one", pty.path(), "holding:0") << bus("two", folder / "no-such-port", at);
  }
  static std::string bus(const std::string& name, const std::string& path, const std::string& at) {
    return "  - name: " + name + "\n    port: { serial: " + path + ", baud: 115200, format: 8N1 }\n" +
           "    protocol: modbus-rtu\n    devices:\n      - name: plc\n        address: 1\n        channels:\n" +
           "          - { name: level, at: \"" + at + "\", type: uint16, refresh: 100ms }\n";
  }

  test::ClaimedDomain domain;
  test::Pty pty;
  std::filesystem::path folder;
  std::string file;
};

TEST_F(DaemonTest, StopsInOrderWithinTwoSecondsOfSigterm) {
  test::ModbusDevice device(pty);
  Process bridge({file});
  ASSERT_THAT(bridge.said("one: the port is open"), HasSubstr("one: the port is open"));
  bridge.signal(SIGTERM);
  EXPECT_EQ(bridge.exit_code(seconds{2}), static_cast<int>(ExitCode::kOk)) << bridge.output();
  EXPECT_THAT(bridge.output(), HasSubstr("stopped"));
}

TEST_F(DaemonTest, RunsWithoutItsPorts) {
  Process bridge({file});
  EXPECT_THAT(bridge.said("two: the port is closed"), HasSubstr("two: the port is closed: No such file or directory"));
  bridge.signal(SIGINT);
  EXPECT_EQ(bridge.exit_code(), 0);
}

TEST_F(DaemonTest, ABadFileLeavesTheOldOneRunning) {
  test::ModbusDevice device(pty);
  Process bridge({file});
  bridge.said("one: the port is open");
  write("holdin:0");
  bridge.signal(SIGHUP);
  EXPECT_THAT(bridge.said("goes on running"), AllOf(HasSubstr("plant.yaml:"), HasSubstr("goes on running")));
  const unsigned reads = device.reads();
  const auto deadline = std::chrono::steady_clock::now() + seconds{10};
  while (device.reads() < reads + 3 && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
  EXPECT_GE(device.reads(), reads + 3);
  bridge.signal(SIGTERM);
  EXPECT_EQ(bridge.exit_code(), 0);
}

TEST_F(DaemonTest, SighupRestartsOnlyTheChangedBus) {
  Process bridge({file});
  bridge.said("one: the port is open");
  write("holding:7");
  bridge.signal(SIGHUP);
  EXPECT_THAT(bridge.said("untouched"), HasSubstr("1 buses stopped, 1 started, 1 untouched"));
  bridge.signal(SIGTERM);
  EXPECT_EQ(bridge.exit_code(), 0);
}

TEST_F(DaemonTest, Sigusr1SwitchesTheWireTrace) {
  test::ModbusDevice device(pty);
  Process bridge({file});
  bridge.said("one: the port is open");
  EXPECT_THAT(bridge.output(), testing::Not(HasSubstr(">>")));
  bridge.signal(SIGUSR1);
  EXPECT_THAT(bridge.said("<< 01 03"),
              AllOf(HasSubstr("one >> 01 03 00 00 00 01 84 0A"), HasSubstr("one << 01 03 02 00 00 B8 44")));
  bridge.signal(SIGUSR1);
  EXPECT_THAT(bridge.said("trace: off"), HasSubstr("trace: off"));
  bridge.signal(SIGTERM);
  EXPECT_EQ(bridge.exit_code(), 0);
}

TEST_F(DaemonTest, CheckTellsWhatAFileConfigures) {
  Process bridge({file, "--check"});
  EXPECT_EQ(bridge.exit_code(), static_cast<int>(ExitCode::kOk));
  EXPECT_THAT(bridge.output(), HasSubstr("1 devices, 1 channels"));
}

// Registers that lie far apart, so that each needs a request of its own.
std::string crowd(std::size_t registers, const std::string& baud, const std::string& refresh) {
  std::string text = "  - name: crowd\n    port: { serial: /dev/none, baud: " + baud + " }\n    protocol: modbus-rtu\n" +
                     "    defaults: { refresh: " + refresh + " }\n    devices:\n      - name: plc\n        address: 1\n        channels:\n";
  for (std::size_t i = 0; i < registers; ++i) {
    text += "          - { name: r" + std::to_string(i) + ", at: \"holding:" + std::to_string(150 * i) + "\", type: uint16 }\n";
  }
  return text;
}

TEST_F(DaemonTest, CheckAndStartWarnOnceOfABusWhoseWireIsTooNarrow) {
  std::ofstream(file, std::ios::app) << crowd(100, "19200", "1s");
  Process check({file, "--check"});
  EXPECT_EQ(check.exit_code(), static_cast<int>(ExitCode::kOk));
  EXPECT_THAT(check.output(), AllOf(HasSubstr("warning: crowd: more is wanted than the wire carries"), HasSubstr("115200 baud")));
  EXPECT_THAT(check.output(), testing::Not(HasSubstr("warning: one")));

  Process bridge({file});
  bridge.said("two: the port is closed");
  bridge.signal(SIGTERM);
  EXPECT_EQ(bridge.exit_code(), 0);
  const std::string said = bridge.output();
  const auto first = said.find("crowd: more is wanted than the wire carries");
  ASSERT_NE(first, std::string::npos) << said;
  EXPECT_EQ(said.find("more is wanted", first + 20), std::string::npos) << said;
}

TEST_F(DaemonTest, ABusThatCouldNeverCarryItsChannelsIsAFault) {
  std::ofstream(file, std::ios::app) << crowd(100, "1200", "10ms");
  Process bridge({file});
  EXPECT_EQ(bridge.exit_code(), static_cast<int>(ExitCode::kBadConfiguration));
  EXPECT_THAT(bridge.output(), AllOf(HasSubstr("plant.yaml:20:5: bus 'crowd' needs "), HasSubstr("'fieldcast plan' tells")));
}

TEST_F(DaemonTest, CheckTellsEveryFaultAndItsPlace) {
  std::ofstream(file, std::ios::app) << bus("three", "/dev/x", "holdin:1") << bus("four", "/dev/y", "holding:99999");
  for (const std::vector<std::string>& arguments : {std::vector{file, std::string("--check")}, std::vector{file}}) {
    Process bridge(arguments);
    EXPECT_EQ(bridge.exit_code(), static_cast<int>(ExitCode::kBadConfiguration));
    EXPECT_THAT(bridge.output(), AllOf(HasSubstr("plant.yaml:27:"), HasSubstr("plant.yaml:35:")));
  }
}

TEST_F(DaemonTest, WrongUsageHasItsOwnCode) {
  Process none({});
  EXPECT_EQ(none.exit_code(), static_cast<int>(ExitCode::kUsage));
  Process unknown({file, "--chekc"});
  EXPECT_EQ(unknown.exit_code(), static_cast<int>(ExitCode::kUsage));
}

TEST_F(DaemonTest, DdsThatCannotBeJoinedHasItsOwnCode) {
  write("holding:0", "203.0.113.77");  // of nobody (RFC 5737)
  Process bridge({file});
  EXPECT_EQ(bridge.exit_code(), static_cast<int>(ExitCode::kCannotStart));
  EXPECT_THAT(bridge.output(), HasSubstr("203.0.113.77"));
}

}  // namespace
}  // namespace fieldcast
