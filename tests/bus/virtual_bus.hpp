// A monitored bus in virtual time (tools/sim/virtual_bus.hpp).
//
// Checks these invariants at every step and reports violations as gtest failures:
// - at most one exchange at a time
// - good values are fresh and correct
// - each command has exactly one result
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tools/sim/bus/virtual_bus.hpp"

namespace fieldcast::test {

class VirtualBus {
 public:
  struct Watched {
    std::uint64_t good = 0, bad = 0;
    Instant last_good{};
    Duration longest_gap{};  // between good samples, since watch_from()
    Quality quality = Quality::kNotYetRead;
    Value value;
  };

  VirtualBus(const BusSpec& spec, const sim::BusFaults& faults, std::uint64_t seed);

  void run_until(Instant until);
  void command(Command command);  // at the current instant; request_id is set here
  void set_interest(ChannelIndex channel, std::optional<Duration> refresh) {
    bus_.feed(InterestChanged{channel, refresh});
  }
  void unplug();
  void plug();
  void stop();  // sends StopRequested
  // A new engine with the first devices of the plant.
  void configure(const BusSpec& spec) { bus_.replace_engine(spec, Duration::zero()); }
  void watch_from_now();  // resets gaps and counters

  // Called for each good sample; returns an error text, empty if the sample is correct.
  std::function<std::string(ChannelIndex, const Value&)> judge;

  [[nodiscard]] Instant now() const { return bus_.now(); }
  [[nodiscard]] BusEngine& engine() { return bus_.engine(); }
  [[nodiscard]] sim::SimBus& plant() { return bus_.plant(); }
  [[nodiscard]] const std::vector<Watched>& channels() const { return watched_; }
  [[nodiscard]] const std::map<std::uint64_t, std::vector<CommandResult>>& results() const {
    return results_;
  }
  [[nodiscard]] std::uint64_t commands_sent() const { return commands_; }
  [[nodiscard]] const std::vector<Notice>& notices() const { return notices_; }
  [[nodiscard]] std::uint64_t sends() const { return sends_; }
  // Equal for two runs only if all their actions were equal.
  [[nodiscard]] std::uint64_t fingerprint() const { return bus_.fingerprint(); }

 private:
  void see(const Action& action);

  std::vector<Watched> watched_;
  std::map<std::uint64_t, std::vector<CommandResult>> results_;
  std::uint64_t commands_ = 0;
  std::uint64_t sends_ = 0;
  std::vector<Notice> notices_;
  sim::VirtualBus bus_;
};

}  // namespace fieldcast::test
