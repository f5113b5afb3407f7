#pragma once

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "bridge/station/station.hpp"
#include "tests/bridge/support/claimed_domain.hpp"
#include "tests/bridge/support/process.hpp"
#include "tests/bridge/support/tcp_device.hpp"

namespace fieldcast::takeover {

using namespace std::chrono_literals;
using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

inline bool within(const std::function<bool()>& condition, milliseconds limit = 20s) {
  const auto deadline = Clock::now() + limit;
  while (!condition()) {
    if (Clock::now() > deadline) return false;
    std::this_thread::sleep_for(2ms);
  }
  return true;
}

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

inline int takeovers() {
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
  // Writes 1..kWrites, one every 15 ms, as a plant without knowledge of bridges; half of them
  // before the master gets `signal`. Returns their ids.
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
  // Sends `signal` to the master; the second bridge logs `told`, and the first returns as standby.
  // Repeats takeovers() times. Returns the longest gap of each; empty on a timeout.
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

}  // namespace fieldcast::takeover
