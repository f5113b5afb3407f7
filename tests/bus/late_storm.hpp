// A bus in virtual time whose devices answer late, twice, or whose answers collide with another
// master: every good value is held against what its address holds.
//
// Each item of a device holds a number made of its device, area and address, so that the value of
// any other address is seen. All devices of a storm have blocks of the same shape: what can be
// mistaken, is. Deterministic by its seed. What tools/bench/storm_bench runs at length.
#pragma once

#include <memory>
#include <ostream>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "core/model/spec.hpp"
#include "tools/sim/bus/virtual_bus.hpp"

namespace fieldcast::test {

// One row for each protocol, and each mode that changes how its answers are told apart.
struct StormKind {
  std::string name;
  std::string protocol, options;  // as the configuration has them
  std::string port;
  int devices = 2;
  std::vector<std::string> addresses;  // of the channels
  std::string type;
  bool foreign = true;  // its answers show whose they are, so that foreign ones can be told apart
  bool writes = true;   // a write changes nothing but its own channel
  friend void PrintTo(const StormKind& kind, std::ostream* out) { *out << kind.name; }
};
[[nodiscard]] std::span<const StormKind> storm_kinds();
[[nodiscard]] BusSpec bus_of(const StormKind& kind, const std::string& timeout);

struct StormFaults {
  double late = 0.05;
  Duration by = std::chrono::milliseconds{250};
  double doubled = 0;
  double foreign = 0;  // conversations a second
  double noise = 0;    // of a bit
};
[[nodiscard]] sim::BusFaults faults_of(const BusSpec& bus, const StormFaults& faults);

class LateStorm {
 public:
  struct Counts {
    std::uint64_t exchanges = 0, late = 0, doubled = 0;
    std::uint64_t good = 0, wrong = 0;  // samples and values of commands
    std::uint64_t commands = 0, answered = 0, failed = 0;
    std::string first_wrong;
  };

  LateStorm(const StormKind& kind, const BusSpec& spec, const sim::BusFaults& faults,
            std::uint64_t seed);
  // Runs until so many requests were sent, with a command about every second.
  void run(std::uint64_t exchanges);
  [[nodiscard]] Counts counts();
  [[nodiscard]] const std::vector<std::uint64_t>& good_of_channels() const { return good_; }
  [[nodiscard]] sim::VirtualBus& bus() { return *bus_; }

 private:
  struct Holds {
    DeviceIndex device;
    const ChannelSpec* spec;
    Value value;
  };
  void fill();
  void see(const Action& action);
  void judge(const Holds& holds, const Value& value);
  void command();

  BusSpec spec_;
  bool writes_;
  std::vector<Holds> channels_;
  std::vector<std::uint64_t> good_;
  Counts counts_;
  std::mt19937_64 random_;
  int idle_ = 0;
  std::vector<std::size_t> asked_;  // channel of each command
  std::unique_ptr<sim::VirtualBus> bus_;
};

}  // namespace fieldcast::test
