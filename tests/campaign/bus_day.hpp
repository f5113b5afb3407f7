// Simulates a day of one bus in virtual time, with commands, interests, programming sessions and
// reloads. Its faults are noise, lost, late, doubled and truncated responses, devices that restart
// with other values, a vanishing port, and a killed engine whose successor finds the wire in use.
//
// These invariants are checked at every step; the first that fails is the day's violation:
//   - a good value is what its device contained a moment ago;
//   - a channel whose last sample is good is published again within its promise, or reported as not
//     good; a channel without a fault is good again soon;
//   - every command has exactly one result, and a command reported as done was executed;
//   - requests never overlap, and none is sent into a closed or a leased port;
//   - memory does not grow.
// Deterministic by protocol and seed. Owns the bus; one thread; no clock, no I/O.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "tests/bus/late_storm.hpp"
#include "tests/campaign/plant_memory.hpp"
#include "tools/sim/bus/virtual_bus.hpp"

namespace fieldcast::test {

struct DayCounts {
  std::uint64_t requests = 0, samples = 0, good = 0;
  std::uint64_t late = 0, doubled = 0;  // responses
  std::uint64_t commands = 0, results = 0, done = 0;
  std::uint64_t unplugged = 0, reloads = 0, takeovers = 0, leases = 0, interests = 0,
                device_restarts = 0;
  std::uint64_t violations = 0;
  void add(const DayCounts& other);
};

class BusDay {
 public:
  static constexpr std::size_t kTranscriptLines = 600;  // the last ones are kept

  // Fault that a test injects to show that the checks find it.
  enum class Sabotage : std::uint8_t {
    kNone,
    kValue,       // a good sample has a wrong value
    kSilence,     // good samples of a channel are dropped
    kNoResult,    // a result is dropped
    kTwoResults,  // a result arrives twice
    kOverlap,     // a request is reported a second time while it is on the wire
    kMemory,      // memory leaks
  };

  BusDay(const StormKind& kind, std::uint64_t seed, Duration length);
  ~BusDay();
  BusDay(const BusDay&) = delete;
  BusDay& operator=(const BusDay&) = delete;

  void sabotage(Sabotage what) { sabotage_ = what; }
  // Records all further events as text.
  void keep_transcript();
  // Runs to the end of the day, to its first violation, or until `stop` returns true. `stop` is
  // called about once a virtual minute.
  void run(const std::function<bool()>& stop = {});

  [[nodiscard]] const std::optional<std::string>& violation() const { return violation_; }
  [[nodiscard]] const std::deque<std::string>& transcript() const { return transcript_; }
  [[nodiscard]] DayCounts counts() const;
  [[nodiscard]] Duration reached() const { return now() - Instant{}; }

 private:
  struct Channel {
    DeviceIndex device = 0;
    const ChannelSpec* spec = nullptr;
    Instant published{};
    std::optional<Duration> gap;  // promised
    bool shown_good = false;
    Instant last_good = kLongAgo, promised{};
    Instant acquired = kLongAgo;  // of the last good sample
  };
  struct Pending {
    ChannelIndex channel = 0;
    std::optional<Value> written;
    Instant sent{};
  };

  [[nodiscard]] Instant now() const { return bus_->now(); }
  [[nodiscard]] double chance() { return std::generate_canonical<double, 53>(random_); }
  [[nodiscard]] Duration between(Duration least, Duration most);
  void begin(Duration absence, const Opened& opened = {});
  void see(const Action& action);
  void see_send(const Send& send);
  void see_sample(const Sample& sample);
  void see_result(const CommandResult& result);
  void judge(ChannelIndex index, const Value& value);
  void judge_done(const Pending& pending, const CommandResult& result);
  void sweep();
  void operate();
  void replace_engine(bool in_order);
  void command();
  void interest();
  void lease();
  void unplug();
  void restart_devices();
  void note(std::string text);
  void violate(const std::string& what);

  const StormKind& kind_;
  std::mt19937_64 random_;
  Duration length_;
  Sabotage sabotage_ = Sabotage::kNone;
  const BusSpec whole_;            // all channels of all variants
  std::vector<BusSpec> variants_;  // of the configuration
  std::size_t variant_ = 0;
  PlantMemory memory_;
  std::vector<Channel> channels_;
  std::map<std::uint64_t, Pending> pending_;
  std::uint64_t next_command_ = 1;
  std::vector<std::pair<Duration, DeviceIndex>> restarts_;  // ends of dead times, in order
  std::size_t restarted_ = 0;
  std::vector<Instant> dead_until_;  // each device
  Instant disturbed_{};              // last time that an event kept the bus from reading
  bool leased_ = false, transcribing_ = false;
  bool busy_ = false;  // the engine runs
  Instant wire_free_{};
  std::size_t first_bytes_ = 0;  // of memory, after the first hours
  std::vector<std::unique_ptr<Bytes>> kept_;
  DayCounts counts_;
  std::optional<std::string> violation_;
  std::deque<std::string> transcript_;
  std::unique_ptr<sim::VirtualBus> bus_;
};

}  // namespace fieldcast::test
