// A bus in virtual time whose devices respond late or twice, or whose responses collide with
// another master. Every good value is compared with the contents of its address.
//
// The number in each item is made of device, area and address, so that a value of any other address
// is detected. All devices have blocks of the same shape, so that mistakes are possible.
// Deterministic by its seed. tools/bench/storm_bench runs it for a long time.
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

// One row for each protocol, and for each mode that changes how its responses are distinguished.
struct StormKind {
  std::string name;
  std::string protocol, options;  // as in the configuration
  std::string port;
  int devices = 2;
  std::vector<std::string> addresses;  // of the channels
  std::string type;
  bool foreign = true;  // its responses identify their station, so that foreign ones are recognized
  bool writes = true;   // a write changes only its own channel
  friend void PrintTo(const StormKind& kind, std::ostream* out) { *out << kind.name; }
};
[[nodiscard]] std::span<const StormKind> storm_kinds();
[[nodiscard]] BusSpec bus_of(const StormKind& kind, const std::string& timeout);

struct StormFaults {
  double late = 0.05;
  Duration by = std::chrono::milliseconds{250};
  double doubled = 0;
  double foreign = 0;  // conversations a second
  double noise = 0;    // probability per bit
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
  // Runs until this number of requests was sent, with a command about every second.
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
