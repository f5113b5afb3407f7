#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "bridge/base/exit_code.hpp"
#include "tests/bridge/support/claimed_domain.hpp"
#include "tests/bridge/support/modbus_device.hpp"
#include "tests/bridge/support/process.hpp"
#include "tests/bridge/support/tcp_client.hpp"

namespace fieldcast {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::AllOf;
using testing::HasSubstr;

struct Process : test::Process {
  explicit Process(const std::vector<std::string>& arguments)
      : test::Process(FIELDCAST_BRIDGE, arguments) {}
  Process(const std::string& program, const std::vector<std::string>& arguments)
      : test::Process(program, arguments) {}
};

struct FullPipe {
  FullPipe() {
    int ends[2];
    EXPECT_EQ(::pipe2(ends, O_CLOEXEC | O_NONBLOCK), 0);
    read_end.reset(ends[0]);
    write_end.reset(ends[1]);
    const std::string filler(4096, '.');
    while (::write(write_end.get(), filler.data(), filler.size()) > 0) {}
    // The daemon's end blocks, as standard output usually does.
    EXPECT_EQ(::fcntl(write_end.get(), F_SETFL, 0), 0);
  }
  FileDescriptor read_end, write_end;
};

struct DaemonTest : testing::Test {
  DaemonTest() {
    folder = std::filesystem::path(testing::TempDir()) /
             ("fieldcast-daemon-" + std::to_string(::getpid()) +
              testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder);
    file = folder / "plant.yaml";
    write("holding:0");
  }
  ~DaemonTest() override { std::filesystem::remove_all(folder); }

  // Bus one uses the pseudo-terminal; bus two has a missing port and a channel at `at`.
  void write(const std::string& at, const std::string& interface = "127.0.0.1") const {
    std::ofstream(file) << "bridge: test\n"
                        << "dds: { domain: " << domain.number() << ", interfaces: ["
                        << interface << "], security: none }\n"
                        << "buses:\n"
                        << bus("one", pty.path(), "holding:0")
                        << bus("two", folder / "no-such-port", at);
  }
  static std::string bus(const std::string& name, const std::string& path, const std::string& at) {
    return "  - name: " + name + "\n    port: { serial: " + path +
           ", baud: 115200, format: 8N1 }\n" +
           "    protocol: modbus-rtu\n    devices:\n      - name: plc\n        address: 1\n        "
           "channels:\n" +
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

bool reads_more(const test::ModbusDevice& device, unsigned reads) {
  const unsigned before = device.reads();
  const auto deadline = std::chrono::steady_clock::now() + seconds{15};
  while (device.reads() < before + reads && std::chrono::steady_clock::now() < deadline)
    std::this_thread::yield();
  return device.reads() >= before + reads;
}

TEST_F(DaemonTest, AFullPipeBehindItsLogStopsNeitherTheBusNorTheSignals) {
  test::ModbusDevice device(pty);
  const FullPipe full;
  test::Process bridge(FIELDCAST_BRIDGE, {file, "--trace"}, full.write_end.get());
  EXPECT_TRUE(reads_more(device, 30));
  bridge.signal(SIGUSR1);
  bridge.signal(SIGHUP);
  EXPECT_TRUE(reads_more(device, 5));
  bridge.signal(SIGTERM);
  EXPECT_EQ(bridge.exit_code(seconds{2}), static_cast<int>(ExitCode::kOk));
}

TEST_F(DaemonTest, AClosedPipeBehindItsLogEndsNothing) {
  test::ModbusDevice device(pty);
  FullPipe closed;
  closed.read_end.reset();
  test::Process bridge(FIELDCAST_BRIDGE, {file, "--trace"}, closed.write_end.get());
  EXPECT_TRUE(reads_more(device, 5));
  bridge.signal(SIGTERM);
  EXPECT_EQ(bridge.exit_code(seconds{2}), static_cast<int>(ExitCode::kOk));
}

TEST_F(DaemonTest, RunsWithoutItsPorts) {
  Process bridge({file});
  EXPECT_THAT(bridge.said("two: the port is closed"),
              HasSubstr("two: the port is closed: " + (folder / "no-such-port").string() +
                        ": No such file or directory"));
  bridge.signal(SIGINT);
  EXPECT_EQ(bridge.exit_code(), 0) << bridge.output();
}

TEST_F(DaemonTest, ABadFileLeavesTheOldOneRunning) {
  test::ModbusDevice device(pty);
  Process bridge({file});
  bridge.said("one: the port is open");
  write("holdin:0");
  bridge.signal(SIGHUP);
  EXPECT_THAT(bridge.said("goes on running"),
              AllOf(HasSubstr("plant.yaml:"), HasSubstr("goes on running")));
  EXPECT_TRUE(reads_more(device, 3));
  bridge.signal(SIGTERM);
  EXPECT_EQ(bridge.exit_code(), 0) << bridge.output();
}

TEST_F(DaemonTest, SighupRestartsOnlyTheChangedBus) {
  Process bridge({file});
  bridge.said("one: the port is open");
  write("holding:7");
  bridge.signal(SIGHUP);
  EXPECT_THAT(bridge.said("untouched"),
              HasSubstr("1 bus stopped (two), 1 started (two), 1 untouched"));
  bridge.signal(SIGTERM);
  EXPECT_EQ(bridge.exit_code(), 0) << bridge.output();
}

TEST_F(DaemonTest, AReloadThatRestartsEverythingSaysSoAndWhy) {
  Process bridge({file});
  bridge.said("one: the port is open");
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  std::string renamed = text.str();
  renamed.replace(0, std::string("bridge: test").size(), "bridge: other");
  std::ofstream(file) << renamed;
  bridge.signal(SIGHUP);
  EXPECT_THAT(bridge.said("reloaded"),
              AllOf(HasSubstr("test: reloading: the bridge test is now called other: all "
                              "buses are restarted: 2 buses"),
                    HasSubstr("other: reloaded: all buses were restarted: 2 buses")));
  bridge.signal(SIGTERM);
  EXPECT_EQ(bridge.exit_code(), 0) << bridge.output();
}

TEST_F(DaemonTest, AFullFileIsAnErrorAndNotTheEnd) {
  test::ModbusDevice device(pty);
  std::ofstream(file, std::ios::app)
      << "store: { path: " << (folder / "plant.db").string() << " }\n";
  const FileDescriptor log(
      ::open((folder / "log").c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600));
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{4'000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);  // inherited by the child
  test::Process bridge(FIELDCAST_BRIDGE, {file, "--trace"}, log.get());
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  const auto full = [&] { return std::filesystem::file_size(folder / "log") >= small.rlim_cur; };
  const auto deadline = std::chrono::steady_clock::now() + seconds{60};
  while (!full() && std::chrono::steady_clock::now() < deadline) ASSERT_TRUE(reads_more(device, 1));
  ASSERT_TRUE(full());
  EXPECT_TRUE(reads_more(device, 10));
  bridge.signal(SIGTERM);
  EXPECT_EQ(bridge.exit_code(seconds{5}), static_cast<int>(ExitCode::kOk));
}

TEST_F(DaemonTest, AReloadThatWouldCutADownloadWaitsAndSaysForWhom) {
  test::ModbusDevice device(pty);
  const std::uint16_t port = test::free_port();
  const auto configure = [&](const std::string& at) {
    std::string one = bus("one", pty.path(), at);
    one.insert(one.find("        address: 1\n"), "        number: P1\n");
    std::ofstream(file) << "bridge: test\n"
                        << "dds: { domain: " << domain.number() << " }\n"
                        << "program: { engineers: { listen: \"127.0.0.1:" << port << "\" } }\n"
                        << "buses:\n"
                        << one;
  };
  configure("holding:0");
  Process bridge({file});
  bridge.said("running: 1 bus");       // engineers can connect once every bus has started
  ASSERT_TRUE(reads_more(device, 1));  // a device is online once its port is open
  test::TcpClient engineer(port);
  engineer.send("@@P1FEFF");
  ASSERT_EQ(engineer.receive("FEFF"), "@@0000FEFF");
  configure("holding:7");
  bridge.signal(SIGHUP);
  EXPECT_THAT(bridge.said("the reload waits"),
              AllOf(HasSubstr("the reload waits for the end of programming: one/plc by 127.0.0.1:"),
                    testing::Not(HasSubstr("1 bus stopped"))));
  engineer.send("@@EDFEFF");
  EXPECT_THAT(bridge.said("1 bus stopped"), HasSubstr("1 bus stopped (one), 1 started (one)"));
  bridge.signal(SIGTERM);
  EXPECT_EQ(bridge.exit_code(), 0) << bridge.output();
}

// Invalid if another program listens there.
FileDescriptor listening_at(std::uint16_t port) {
  FileDescriptor fd(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const bool listens =
      ::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
      ::listen(fd.get(), 1) == 0;
  return listens ? std::move(fd) : FileDescriptor{};
}

TEST_F(DaemonTest, AReloadThatLeavesNothingRunningSaysSoUntilTheOldConfigurationRunsAgain) {
  test::ModbusDevice device(pty);
  const std::uint16_t own = test::free_port(), wanted = test::free_port();
  const auto configure = [&](const std::string& name, std::uint16_t port) {
    std::ofstream(file) << "bridge: " << name << "\n"
                        << "dds: { domain: " << domain.number() << " }\n"
                        << "program: { engineers: { listen: \"127.0.0.1:" << port << "\" } }\n"
                        << "buses:\n"
                        << bus("one", pty.path(), "holding:0");
  };
  configure("test", own);
  Process bridge({file});
  bridge.said("running: 1 bus");
  const FileDescriptor taken = listening_at(wanted);
  configure("other", wanted);
  bridge.signal(SIGHUP);
  // The port is free while the bridge tries to start with the new file.
  FileDescriptor also_taken;
  const auto deadline = std::chrono::steady_clock::now() + seconds{15};
  while (!also_taken.valid() && std::chrono::steady_clock::now() < deadline)
    also_taken = listening_at(own);
  ASSERT_TRUE(also_taken.valid());
  EXPECT_THAT(bridge.said("not reloaded"),
              AllOf(HasSubstr("the old configuration does not start again, so no bus runs"),
                    testing::Not(HasSubstr("goes on running"))));
  also_taken.reset();
  EXPECT_THAT(bridge.said("runs again"), HasSubstr("the old configuration runs again"));
  EXPECT_TRUE(reads_more(device, 3));
  bridge.signal(SIGTERM);
  EXPECT_EQ(bridge.exit_code(), 0) << bridge.output();
}

TEST_F(DaemonTest, Sigusr1SwitchesTheWireTrace) {
  test::ModbusDevice device(pty);
  Process bridge({file});
  bridge.said("one: the port is open");
  EXPECT_THAT(bridge.output(), testing::Not(HasSubstr(">>")));
  bridge.signal(SIGUSR1);
  bridge.said("one >> 01 03");  // the trace may begin between a request and its response
  EXPECT_THAT(bridge.said("<< 01 03"), AllOf(HasSubstr("one >> 01 03 00 00 00 01 84 0A"),
                                             HasSubstr("one << 01 03 02 00 00 B8 44")));
  bridge.signal(SIGUSR1);
  EXPECT_THAT(bridge.said("trace: off"), HasSubstr("trace: off"));
  bridge.signal(SIGTERM);
  EXPECT_EQ(bridge.exit_code(), 0) << bridge.output();
}

TEST_F(DaemonTest, CheckReportsWhatAFileConfigures) {
  Process bridge({file, "--check"});
  EXPECT_EQ(bridge.exit_code(), static_cast<int>(ExitCode::kOk));
  EXPECT_THAT(bridge.output(), HasSubstr("1 device, 1 channel"));
}

TEST_F(DaemonTest, CheckPlacesEachFaultOfACaptureFolder) {
  std::ofstream(folder / "file") << "x";
  std::ofstream(file, std::ios::app)
      << "  - name: kept\n    port: { serial: /dev/none }\n    protocol: modbus-rtu\n"
         "    capture: { folder: /no/such/folder }\n"
         "    devices: [ { name: plc, address: 1, allow: [raw-read] } ]\n"
         "  - name: wrong\n    port: { serial: /dev/other }\n    protocol: modbus-rtu\n"
         "    devices: [ { name: plc, address: 1, allow: [raw-read] } ]\n"
         "    capture:\n      folder: file\n";
  Process check({file, "--check"});
  EXPECT_EQ(check.exit_code(), static_cast<int>(ExitCode::kOk));
  EXPECT_THAT(
      check.output(),
      AllOf(HasSubstr(file + ":23:24: warning: kept: capture: /no/such/folder: No such file or "
                             "directory: the bus runs, and nothing is captured; mkdir "
                             "/no/such/folder, with the user that runs the bridge as its owner\n"),
            HasSubstr(file + ":30:15: warning: wrong: capture: " + (folder / "file").string() +
                      ": this is no folder: the bus runs, nothing is captured; name a folder\n")));
}

TEST_F(DaemonTest, CheckPlacesAFileOfTheProgrammingPort) {
  std::ofstream(file, std::ios::app)
      << "program:\n  modules: { listen: 127.0.0.1:1, secrets: words }\n";
  std::ofstream(folder / "words") << "# none\n";
  std::filesystem::permissions(folder / "words", std::filesystem::perms(0600));
  Process check({file, "--check"});
  EXPECT_EQ(check.exit_code(), static_cast<int>(ExitCode::kBadConfiguration));
  EXPECT_THAT(check.output(), HasSubstr(file + ":21:44: program: modules: " +
                                        (folder / "words").string() + ": no secret is in it\n"));
}

TEST_F(DaemonTest, CheckWarnsOfChannelsThatLieOnEachOther) {
  std::ofstream(file, std::ios::app)
      << "  - name: slip\n    port: { serial: /dev/none }\n    protocol: modbus-rtu\n"
         "    devices:\n      - name: plc\n        address: 1\n        channels:\n"
         "          - { name: a, at: \"holding:100\", type: float32 }\n"
         "          - { name: b, at: \"holding:101\", type: float32 }\n";
  Process check({file, "--check"});
  EXPECT_EQ(check.exit_code(), static_cast<int>(ExitCode::kOk));
  EXPECT_THAT(check.output(),
              HasSubstr("warning: slip: plc/a (holding:100, float32) and plc/b (holding:101"));
}

TEST_F(DaemonTest, CheckWarnsOfALimitThatNoValueExceeds) {
  std::ofstream(file, std::ios::app)
      << "  - name: slip\n    port: { serial: /dev/none }\n    protocol: modbus-rtu\n"
         "    devices:\n      - name: plc\n        address: 1\n        channels:\n"
         "          - { name: a, at: \"holding:100\", type: int16, limits: { high: 40000 } }\n";
  Process check({file, "--check"});
  EXPECT_EQ(check.exit_code(), static_cast<int>(ExitCode::kOk));
  EXPECT_THAT(check.output(), HasSubstr("warning: slip: plc/a: no value is above the limit 'high' "
                                        "40000; its type has -32768 to 32767\n"));
}

TEST_F(DaemonTest, CheckWarnsOfAPatternOfTheStoreThatMatchesNoChannel) {
  std::ofstream(file, std::ios::app)
      << "store: { path: kept.db, samples: [one, two/*/oil, \"*/plc/level\"] }\n";
  Process check({file, "--check"});
  EXPECT_EQ(check.exit_code(), static_cast<int>(ExitCode::kOk));
  EXPECT_THAT(check.output(),
              AllOf(HasSubstr("warning: store: samples: no channel matches two/*/oil\n"),
                    testing::Not(HasSubstr("matches one")), testing::Not(HasSubstr("*/plc"))));
}

std::string crowd(std::size_t registers, const std::string& baud, const std::string& refresh) {
  std::string text = "  - name: crowd\n    port: { serial: /dev/none, baud: " + baud +
                     " }\n    protocol: modbus-rtu\n" + "    defaults: { refresh: " + refresh +
                     " }\n    devices:\n      - name: plc\n        address: 1\n        channels:\n";
  for (std::size_t i = 0; i < registers; ++i) {
    text += "          - { name: r" + std::to_string(i) +
            ", at: \"holding:" + std::to_string(150 * i) + "\", type: uint16 }\n";
  }
  return text;
}

TEST_F(DaemonTest, CheckAndStartWarnOnceOfABusWhoseWireIsTooNarrow) {
  std::ofstream(file, std::ios::app) << crowd(100, "19200", "1s");
  Process check({file, "--check"});
  EXPECT_EQ(check.exit_code(), static_cast<int>(ExitCode::kOk));
  EXPECT_THAT(check.output(),
              AllOf(HasSubstr("warning: crowd: more is wanted than the wire carries"),
                    HasSubstr("57600 baud")));
  EXPECT_THAT(check.output(), testing::Not(HasSubstr("warning: one")));

  Process bridge({file});
  bridge.said("two: the port is closed");
  bridge.signal(SIGTERM);
  EXPECT_EQ(bridge.exit_code(), 0) << bridge.output();
  const std::string said = bridge.output();
  const auto first = said.find("crowd: more is wanted than the wire carries");
  ASSERT_NE(first, std::string::npos) << said;
  EXPECT_EQ(said.find("more is wanted", first + 20), std::string::npos) << said;
}

TEST_F(DaemonTest, ABusThatCouldNeverCarryItsChannelsIsAFault) {
  std::ofstream(file, std::ios::app) << crowd(100, "1200", "10ms");
  Process bridge({file});
  EXPECT_EQ(bridge.exit_code(), static_cast<int>(ExitCode::kBadConfiguration));
  EXPECT_THAT(bridge.output(), AllOf(HasSubstr("plant.yaml:20:5: bus 'crowd' needs "),
                                     HasSubstr("'fieldcast plan' shows")));
}

TEST_F(DaemonTest, CheckReportsEveryFaultAndItsPlace) {
  std::ofstream(file, std::ios::app)
      << bus("three", "/dev/x", "holdin:1") << bus("four", "/dev/y", "holding:99999");
  for (const std::vector<std::string>& arguments :
       {std::vector{file, std::string("--check")}, std::vector{file}}) {
    Process bridge(arguments);
    EXPECT_EQ(bridge.exit_code(), static_cast<int>(ExitCode::kBadConfiguration));
    EXPECT_THAT(bridge.output(), AllOf(HasSubstr("plant.yaml:27:"), HasSubstr("plant.yaml:35:")));
  }
}

// The bounds of the real program are 5 s and 300 MB. Here they are higher: the process maps more
// than it uses (libraries, stacks, arenas), and a sanitizer or a busy machine is slower.
struct HardFile {
  std::string text;
  std::string_view told;
};

std::string repeated(std::string_view part, std::size_t times) {
  std::string text;
  text.reserve(part.size() * times);
  for (std::size_t i = 0; i < times; ++i) text += part;
  return text;
}

std::vector<HardFile> hard_files() {
  std::string keys = "bridge: b\n", bomb = "bridge: b\na0: &a0 [x, x, x, x, x, x, x, x, x]\n";
  for (int i = 0; i < 1'000'000; ++i) keys += "k" + std::to_string(i) + ": 1\n";
  for (int i = 1; i < 20; ++i) {
    const auto last = ", *a" + std::to_string(i - 1);
    bomb +=
        "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [x" + repeated(last, 9) + "]\n";
  }
  return {{keys, "too many keys"},
          {bomb, "too many values"},
          {repeated("[", 15u << 20).insert(0, "buses: "), "too deep nesting"},
          {repeated("&a ", 5'000'000).insert(0, "buses: "), "no key can stand here"},
          {repeated("\"\",", 1'600'000).insert(0, "buses: ["), "this '[' is never closed"},
          {repeated("- - a\n", 399'000), "this is no Fieldcast configuration"},
          {repeated("- ''\n", 1'499'000), "this is no Fieldcast configuration"},
          {repeated("- x\n", 1'499'000) + "\"", "plant.yaml"},
          {"bridge: \"" + repeated("x\n", 8'000'000), "too many lines"},
          {"bridge: " + repeated("x", 10'000'000), "plant.yaml"},
          {repeated("bridge: b\n", 20'000'000), "too large; allowed: 16 MiB"}};
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_F(DaemonTest, CheckEndsSoonAndSmallOnAnyFile) {
  for (const HardFile& hard : hard_files()) {
    std::ofstream(file) << hard.text;
    Process check("/bin/sh",
                  {"-c", "ulimit -t 20 && ulimit -d 400000 && exec \"$0\" \"$1\" --check",
                   FIELDCAST_BRIDGE, file});
    EXPECT_EQ(check.exit_code(seconds{120}), static_cast<int>(ExitCode::kBadConfiguration))
        << hard.told << hard.text.substr(0, 40);
    EXPECT_THAT(check.output(), HasSubstr(std::string(hard.told)));
  }
}
#endif

TEST_F(DaemonTest, WrongUsageHasItsOwnCode) {
  Process none({});
  EXPECT_EQ(none.exit_code(), static_cast<int>(ExitCode::kUsage));
  Process unknown({file, "--chekc"});
  EXPECT_EQ(unknown.exit_code(), static_cast<int>(ExitCode::kUsage));
}

TEST_F(DaemonTest, DdsThatCannotBeJoinedHasItsOwnCode) {
  write("holding:0", "203.0.113.77");  // unassigned (RFC 5737)
  Process bridge({file});
  EXPECT_EQ(bridge.exit_code(), static_cast<int>(ExitCode::kCannotStart));
  EXPECT_THAT(bridge.output(), HasSubstr("203.0.113.77"));
}

}  // namespace
}  // namespace fieldcast
