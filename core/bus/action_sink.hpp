// Where the parts of a bus engine put what they want done: a narrow way to append actions. Made for
// one event, on the stack; keeps references to the event's actions and to the engine's setup.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/bus/bus_setup.hpp"
#include "core/bus/event.hpp"

namespace fieldcast {

class ActionSink {
 public:
  // `samples`: the counter of samples that were published. `tracing`: traces are wanted.
  ActionSink(const BusSetup& setup, std::uint64_t& samples, Actions& actions, bool tracing = false)
      : setup_(setup), samples_(samples), actions_(actions), tracing_(tracing) {}

  // Publishes the samples, if there are any, and counts them.
  void publish(std::vector<Sample> samples) {
    samples_ += samples.size();
    publish_uncounted(std::move(samples));
  }
  // Likewise for samples that say nothing of the device: first ones, and those of a lease.
  void publish_uncounted(std::vector<Sample> samples) {
    if (!samples.empty()) push(Publish{std::move(samples)});
  }
  // A notice about a device.
  void notice(Notice::Kind kind, DeviceIndex device, Cause cause, std::string text) {
    push(Notice{kind, setup_.device(device).name, cause, std::move(text)});
  }
  [[nodiscard]] bool tracing() const { return tracing_; }
  // How an exchange with a device ended. REQUIRES: tracing().
  void trace(DeviceIndex device, std::string text) {
    push(Traced{setup_.device(device).name, std::move(text)});
  }
  void push(Action action) { actions_.push_back(std::move(action)); }

 private:
  const BusSetup& setup_;
  std::uint64_t& samples_;
  Actions& actions_;
  bool tracing_;
};

}  // namespace fieldcast
