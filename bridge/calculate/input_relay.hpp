// Passes samples of a bus to the calculated channels of other buses. Any thread. A sample is copied
// under a lock and fetched on the thread of the receiving bus; of several for one input, the newest
// remains, so nothing grows if a bus hangs.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/bus_spec.hpp"
#include "core/model/calculation.hpp"
#include "core/model/sample.hpp"

namespace fieldcast {

class InputRelay {
 public:
  // Returns and removes what has arrived. Called on the thread of the receiving bus.
  using Fetch = std::function<std::vector<InputSample>()>;
  struct Bus {
    std::function<void(Fetch)> deliver;  // posts a call of it to the thread of the bus
    std::function<void()> repeat;        // lets the bus publish again what is not good
  };

  // Call when the bus has started. `all`: the configured buses.
  void add(const BusSpec& spec, const std::vector<BusSpec>& all, Bus bus);
  // Inputs from the bus become UNCERTAIN.
  void remove(const std::string& bus);

  // On the thread of the bus. Costs one load if no bus has an input on a different one.
  void publish(std::string_view bus, std::span<const Sample> samples);

 private:
  struct Receiver {
    explicit Receiver(std::size_t inputs) : pending(inputs) {}
    std::vector<InputSample> fetch();
    std::mutex mutex;
    std::vector<std::optional<InputSample>> pending;  // by input
    bool posted = false;
  };
  struct Known {
    Bus bus;
    std::vector<ChannelPath> inputs;
    std::shared_ptr<Receiver> receiver;
  };
  struct Target {
    std::string bus;
    std::size_t input = 0;
  };
  using Targets = std::multimap<ChannelIndex, Target>;

  void put(const Target& target, InputSample sample);
  void route(const BusSpec& source);

  std::atomic<bool> used_{false};
  std::mutex mutex_;
  std::map<std::string, Known, std::less<>> buses_;     // those that run
  std::map<std::string, Targets, std::less<>> routes_;  // by the bus of the inputs
};

}  // namespace fieldcast
