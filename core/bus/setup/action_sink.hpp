// Appends the actions of one event; keeps references to the event's actions and the engine's setup.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/bus/setup/bus_setup.hpp"
#include "core/bus/setup/event.hpp"

namespace fieldcast {

class ActionSink {
 public:
  // `samples`: counter of published samples.
  ActionSink(const BusSetup& setup, std::uint64_t& samples, Actions& actions, bool tracing = false)
      : setup_(setup), samples_(samples), actions_(actions), tracing_(tracing) {}

  void publish(std::vector<Sample> samples) {
    samples_ += samples.size();
    publish_uncounted(std::move(samples));
  }
  // Publishes without counting: first samples, and samples that only report a lease.
  void publish_uncounted(std::vector<Sample> samples) {
    if (!samples.empty()) push(Publish{std::move(samples)});
  }
  void notice(Notice::Kind kind, DeviceIndex device, Cause cause, std::string text) {
    push(Notice{kind, setup_.device(device).name, cause, std::move(text)});
  }
  [[nodiscard]] bool tracing() const { return tracing_; }
  // REQUIRES: tracing().
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
