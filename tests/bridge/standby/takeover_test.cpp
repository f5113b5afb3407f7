// Two bridges of one standby group as real processes, a device that takes connections of both, and
// a station: what it sees when the master is killed, stopped, or hands over.
//
// FIELDCAST_TAKEOVERS=20 does each so often, and prints the longest gaps of a channel.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <set>

#include "bridge/dds/standby_channel.hpp"
#include "bridge/station/station.hpp"
#include "tests/bridge/support/claimed_domain.hpp"
#include "tests/bridge/support/process.hpp"
#include "tests/bridge/support/tcp_device.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using std::chrono::milliseconds;
using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

bool within(const std::function<bool()>& condition, milliseconds limit = 20s) {
  const auto deadline = Clock::now() + limit;
  while (!condition()) {
    if (Clock::now() > deadline) return false;
    std::this_thread::sleep_for(2ms);
  }
  return true;
}

// What a station sees of the channel that is read fastest.
class Watch {
 public:
  explicit Watch(std::uint32_t domain) : station_(spec(domain), "watch") {
    station_.on_result([this](const StationResult& result) {
      const std::lock_guard lock(mutex_);
      ++results_[result.request_id];
      last_result_[result.request_id] = result;
    });
    station_.subscribe_samples(
        [this](const StationSample& sample) {
          const std::lock_guard lock(mutex_);
          std::uint64_t& sequence = sequences_[sample.channel];
          if (sample.sequence <= sequence) fault_ = "a sequence went back";
          sequence = sample.sequence;
          if (sample.channel != "count") return;
          const auto now = Clock::now();
          if (sample.quality != Quality::kGood) {
            ++bad_;
            return;
          }
          if (good_ > 0) longest_ = std::max(longest_, now - last_);
          last_ = now;
          ++good_;
        },
        [this](const auto&, const auto&, const auto& channel) {
          const std::lock_guard lock(mutex_);
          fault_ = "channel " + channel + " is reported as gone";
        });
  }
  static DdsSpec spec(std::uint32_t domain) {
    DdsSpec spec;
    spec.domain = domain;
    return spec;
  }

  std::uint64_t good() {
    const std::lock_guard lock(mutex_);
    return good_;
  }
  // Since the last call.
  milliseconds longest_gap() {
    const std::lock_guard lock(mutex_);
    return std::chrono::duration_cast<milliseconds>(std::exchange(longest_, {}));
  }
  std::string fault() {
    const std::lock_guard lock(mutex_);
    return fault_;
  }
  std::map<std::uint64_t, int> results() {
    const std::lock_guard lock(mutex_);
    return results_;
  }
  std::map<std::uint64_t, StationResult> last_results() {
    const std::lock_guard lock(mutex_);
    return last_result_;
  }
  std::uint64_t sequence_of(const std::string& channel) {
    const std::lock_guard lock(mutex_);
    return sequences_[channel];
  }
  Station& station() { return station_; }

 private:
  std::mutex mutex_;
  std::uint64_t good_ = 0, bad_ = 0;
  std::map<std::string, std::uint64_t> sequences_;  // by channel
  Clock::duration longest_{};
  Clock::time_point last_;
  std::string fault_;
  std::map<std::uint64_t, int> results_;
  std::map<std::uint64_t, StationResult> last_result_;
  Station station_;
};

std::uint16_t free_udp_port() {
  const FileDescriptor any(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  EXPECT_EQ(::bind(any.get(), reinterpret_cast<sockaddr*>(&address), size), 0);
  EXPECT_EQ(::getsockname(any.get(), reinterpret_cast<sockaddr*>(&address), &size), 0);
  return ntohs(address.sin_port);
}

int takeovers() {
  const char* const wanted = std::getenv("FIELDCAST_TAKEOVERS");
  return wanted == nullptr ? 1 : std::atoi(wanted);
}

struct TakeoverTest : testing::Test {
  TakeoverTest()
      : folder(std::filesystem::path(testing::TempDir()) /
               ("fieldcast-takeover-" + std::to_string(::getpid()) +
                testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::create_directories(folder);
  }
  ~TakeoverTest() override {
    if (HasFailure()) std::printf("%s\n%s\n", said("a").c_str(), said("b").c_str());
    std::filesystem::remove_all(folder);
  }

  // Starts a bridge whose output goes to a file.
  std::unique_ptr<test::Process> launch(const std::string& name, int strength) {
    const std::string file = folder / (name + ".yaml");
    std::ofstream(file)
        << "bridge: { name: " << name << ", standby: { group: g, strength: " << strength
        << " } }\ndds: { domain: " << domain.number() << dds
        << " }\nbuses:\n  - name: one\n    port: { tcp: 127.0.0.1:" << device.port()
        << " }\n    protocol: modbus-tcp\n"
        << "    devices:\n      - name: plc\n        address: 1\n        channels:\n"
        << "          - { name: count, at: \"holding:0\", type: uint16, refresh: "
           "50ms }\n"
        << "          - { name: level, at: \"holding:9\", type: uint16, access: "
           "read-write, refresh: 200ms }\n";
    const FileDescriptor output(::open((folder / (name + ".log")).c_str(),
                                       O_CREAT | O_WRONLY | O_APPEND | O_CLOEXEC, 0600));
    return std::make_unique<test::Process>(FIELDCAST_BRIDGE, std::vector<std::string>{file},
                                           output.get());
  }
  std::string said(const std::string& name) const {
    std::ifstream file(folder / (name + ".log"));
    return {std::istreambuf_iterator<char>(file), {}};
  }
  bool says(const std::string& name, const std::string& text, std::size_t times = 1) const {
    return within([&] {
      const std::string all = said(name);
      std::size_t count = 0;
      for (auto at = all.find(text); at != std::string::npos; at = all.find(text, at + 1)) ++count;
      return count >= times;
    });
  }
  // "a" is master, "b" stands by and follows.
  void start_both() {
    a = launch("a", 2);
    ASSERT_TRUE(says("a", "is master of group g"));
    b = launch("b", 1);
    ASSERT_TRUE(says("b", "stands by in group g"));
    const auto good = watch.good();
    ASSERT_TRUE(within([&] { return watch.good() > good + 20; }));
    std::this_thread::sleep_for(500ms);
    (void)watch.longest_gap();
  }
  void expect_samples() {
    const auto good = watch.good();
    EXPECT_TRUE(within([&] { return watch.good() > good + 10; }));
  }
  // No request over one connection after the first over a later one.
  void expect_one_master() {
    int newest = 0;
    for (const auto& request : device.requests()) {
      EXPECT_GE(request.connection, newest) << "two masters ask the device";
      newest = std::max(newest, request.connection);
    }
  }
  std::uint64_t write(int value) {
    StationCommand command;
    command.bus = "one";
    command.command.device = "plc";
    command.command.target = ChannelTarget{"level"};
    command.command.values = {Value{static_cast<std::uint64_t>(value)}};
    command.lifespan = 10s;
    const auto id = watch.station().send(command, 5s);
    EXPECT_TRUE(id) << "write " << value;
    return id.value_or(0);
  }
  // Writes 1..kWrites, one each 15 ms, as a plant that knows of no bridges; half of them before
  // the master gets `signal`. Their ids.
  static constexpr int kWrites = 60;
  std::vector<std::uint64_t> write_while_the_master_gets(int signal) {
    std::vector<std::uint64_t> ids;
    for (int i = 1; i <= kWrites; ++i) {
      ids.push_back(write(i));
      if (i == kWrites / 2) a->signal(signal);
      std::this_thread::sleep_for(15ms);
    }
    EXPECT_TRUE(within([&] { return watch.results().size() == ids.size(); }));
    return ids;
  }
  // The master gets `signal`, the other one says `told`, the first comes back as a standby; as many
  // times as takeovers() says. The longest gap of each; none: something did not come.
  std::vector<milliseconds> take_over_in_turn(int signal, const std::string& told) {
    std::vector<milliseconds> gaps;
    for (int i = 0; i < takeovers(); ++i) {
      const bool even = i % 2 == 0;
      std::unique_ptr<test::Process>& master = even ? a : b;
      const auto taken = static_cast<std::size_t>(i) / 2 + 1;
      master->signal(signal);
      EXPECT_TRUE(says(even ? "b" : "a", told, taken));
      expect_samples();
      if (signal == SIGTERM) { EXPECT_EQ(master->exit_code(), 0); }
      if (HasFailure()) return {};
      gaps.push_back(watch.longest_gap());
      if (i + 1 == takeovers()) break;
      master = launch(even ? "a" : "b", even ? 2 : 1);
      EXPECT_TRUE(says(even ? "a" : "b", "stands by in group g", taken + 1));
      std::this_thread::sleep_for(1s);
      (void)watch.longest_gap();
    }
    return gaps;
  }
  void print(const char* what, std::vector<milliseconds> gaps) {
    std::sort(gaps.begin(), gaps.end());
    std::printf(
        "%s: longest gap of a channel of 50 ms over %zu: median %lld ms, greatest %lld ms\n", what,
        gaps.size(), static_cast<long long>(gaps[gaps.size() / 2].count()),
        static_cast<long long>(gaps.back().count()));
  }

  std::filesystem::path folder;
  std::string dds;  // more of its section in the configuration
  test::ClaimedDomain domain;
  test::TcpDevice device;
  Watch watch{domain.number()};
  std::unique_ptr<test::Process> a, b;
};

TEST_F(TakeoverTest, AMasterThatIsKilledIsReplacedAndItsSequencesGoOn) {
  start_both();
  const auto gaps = take_over_in_turn(SIGKILL, "has taken over in group g");
  ASSERT_FALSE(gaps.empty());
  print("kill -9", gaps);
  EXPECT_LE(gaps.back(), 1s);  // an idle machine: docs/redundancy.md
  EXPECT_EQ(watch.fault(), "");
  expect_one_master();
}

TEST_F(TakeoverTest, AMasterThatEndsHandsOverWithoutAMissedRefresh) {
  start_both();
  const auto gaps = take_over_in_turn(SIGTERM, "the master has handed over");
  ASSERT_FALSE(gaps.empty());
  print("SIGTERM", gaps);
  EXPECT_LE(gaps.back(), 300ms);
  EXPECT_EQ(watch.fault(), "");
  expect_one_master();
}

TEST_F(TakeoverTest, AMasterThatStoodStillDoesNotSpeakAgainAndStandsBy) {
  start_both();
  a->signal(SIGSTOP);
  ASSERT_TRUE(says("b", "has taken over in group g"));
  expect_samples();
  print("a master that falls silent", {watch.longest_gap()});
  std::set<std::uint64_t> ids;
  for (int value = 1; value <= 5; ++value) ids.insert(write(value));
  EXPECT_TRUE(within([&] { return watch.results().size() == ids.size(); }));
  a->signal(SIGCONT);  // finds the five, too
  ASSERT_TRUE(says("a", "steps back"));
  ASSERT_TRUE(says("a", "stands by in group g", 2));
  expect_samples();
  for (const auto& [id, count] : watch.results()) EXPECT_EQ(count, 1) << id;
  for (const auto& [id, result] : watch.last_results())
    EXPECT_EQ(result.state, CommandState::kDone) << id << ": " << result.reason;
  EXPECT_EQ(watch.fault(), "");
  expect_one_master();
}

// After a cut of the network a third one tells of a term that nobody is master of any more: whoever
// was, has published greater numbers.
TEST_F(TakeoverTest, AMasterThatRemainsAfterACutCountsAboveTheOneThatLeft) {
  start_both();
  Domain outside(Watch::spec(domain.number()), "third", nullptr);
  StandbyChannelHandlers nobody;
  nobody.member = [](const auto&) {};
  nobody.lost = [](const auto&) {};
  nobody.note = [](const auto&) {};
  nobody.request = [](const auto&) {};
  StandbyChannel third(outside, "third", "g", 0, nobody);
  StandbyMessage told;
  told.group = "g";
  told.member.bridge = "third";
  told.member.since = 1;
  told.member.not_ready = "it only knows of another master";
  told.member.term = StandbyTerm{7} << 32 | 1;
  EXPECT_TRUE(within([&] {
    ++told.member.beat;
    third.tell(told);
    return watch.sequence_of("count") > sequences_of(told.member.term) &&
           watch.sequence_of("level") > sequences_of(told.member.term);
  }));
  EXPECT_TRUE(says("a", "remains master of group g, term 8"));
  expect_samples();
  write(17);
  EXPECT_TRUE(within([&] { return watch.results().size() == 1; }));
  EXPECT_EQ(watch.last_results().begin()->second.state, CommandState::kDone);
  EXPECT_EQ(watch.fault(), "");
  expect_one_master();
}

// Each write is carried out at most once, and has a result.
TEST_F(TakeoverTest, OverAKillEachCommandHasAResultAndNoWriteRunsTwice) {
  start_both();
  const auto ids = write_while_the_master_gets(SIGKILL);
  const auto results = watch.last_results();
  const auto written = device.writes();
  int done = 0;
  for (int i = 1; i <= kWrites; ++i) {
    const auto found = results.find(ids[static_cast<std::size_t>(i - 1)]);
    if (found == results.end()) {
      ADD_FAILURE() << "no result of command " << i;
      continue;
    }
    const auto count = written.find(static_cast<std::uint16_t>(i));
    const int times = count == written.end() ? 0 : count->second;
    EXPECT_LE(times, 1) << i;
    if (found->second.state != CommandState::kDone) continue;
    ++done;
    EXPECT_EQ(times, 1) << i;
  }
  EXPECT_GE(done, kWrites / 2);  // what was under way at the kill is FAILED
  for (const auto& [id, count] : watch.results()) EXPECT_EQ(count, 1) << id;
}

// Nobody is found before the server is there.
TEST_F(TakeoverTest, MembersThatStartBeforeTheirDiscoveryServerWaitForIt) {
  const std::string server = "/usr/bin/fast-discovery-server";
  if (::access(server.c_str(), X_OK) != 0) GTEST_SKIP() << "fastdds-tools is not installed";
  const std::string port = std::to_string(free_udp_port());
  dds = ", discovery-servers: [\"127.0.0.1:" + port + "\"]";
  a = launch("a", 1);
  b = launch("b", 1);
  ASSERT_TRUE(says("a", "waits for a discovery server: none has answered"));
  ASSERT_TRUE(says("b", "waits for a discovery server: none has answered"));
  const auto is_master = [this](const std::string& name) {
    return said(name).find("is master of group g") != std::string::npos;
  };
  EXPECT_FALSE(is_master("a") || is_master("b"));
  const test::Process runs(server,
                           std::vector<std::string>{"-i", "0", "-l", "127.0.0.1", "-p", port});
  ASSERT_TRUE(says("a", "stands by in group g"));
  ASSERT_TRUE(says("b", "stands by in group g"));
  EXPECT_TRUE(within([&] { return is_master("a") || is_master("b"); }));
}

TEST_F(TakeoverTest, OverAHandOverEveryCommandIsDoneOnce) {
  start_both();
  (void)write_while_the_master_gets(SIGTERM);
  for (const auto& [id, result] : watch.last_results())
    EXPECT_EQ(result.state, CommandState::kDone) << id << ": " << result.reason;
  for (const auto& [id, count] : watch.results()) EXPECT_EQ(count, 1) << id;
  const auto written = device.writes();
  for (int i = 1; i <= kWrites; ++i)
    EXPECT_EQ(written.count(static_cast<std::uint16_t>(i)), 1u) << i;
  for (const auto& [value, count] : written) EXPECT_EQ(count, 1) << value;
}

}  // namespace
}  // namespace fieldcast
