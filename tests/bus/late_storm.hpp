// Simulates a bus in virtual time with late and duplicate responses and collisions with another
// master, and compares each good value with the content of its address.
//
// Each item holds a number derived from device, area and address, so a value of any other address
// is detected. All devices have blocks of the same shape, so their responses can be confused.
// Deterministic for a seed. tools/bench/storm_bench does long runs.
#pragma once

#include <memory>
#include <ostream>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "core/model/bus_spec.hpp"
#include "tools/sim/bus/virtual_bus.hpp"

namespace fieldcast::test {

struct StormKind {
  std::string name;
  std::string protocol, options;  // as in the configuration
  std::string port;
  int devices = 2;
  std::vector<std::string> addresses;  // of the channels
  std::string type;
  bool foreign = true;  // responses identify their sender, so foreign ones are detected
  bool writes = true;   // a write changes only its own channel
  friend void PrintTo(const StormKind& kind, std::ostream* out) { *out << kind.name; }
};
[[nodiscard]] std::span<const StormKind> storm_kinds();
[[nodiscard]] BusSpec bus_of(const StormKind& kind, const std::string& timeout);

struct StormFaults {
  double late = 0.05;
  Duration by = std::chrono::milliseconds{250};
  double doubled = 0;
  double foreign = 0;  // foreign exchanges per second
  double noise = 0;    // bit error probability
};
[[nodiscard]] sim::BusFaults faults_of(const BusSpec& bus, const StormFaults& faults);

class LateStorm {
 public:
  struct Counts {
    std::uint64_t exchanges = 0, late = 0, doubled = 0;
    std::uint64_t good = 0, wrong = 0;  // samples and command values
    std::uint64_t commands = 0, answered = 0, failed = 0;
    std::string first_wrong;
  };

  LateStorm(const StormKind& kind, const BusSpec& spec, const sim::BusFaults& faults,
            std::uint64_t seed);
  // Runs until `exchanges` requests were sent, with about one command per second.
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
