// One exchange in virtual time: live against the simulated device, or against bytes that are known.
// The engine's own driver of an exchange is between them, with its timers.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/bus/exchange_driver.hpp"
#include "tools/sim/bus/sim_bus.hpp"
#include "tools/sim/check/subject.hpp"

namespace fieldcast::sim {

struct RunOutcome {
  bool done = false;
  Cause cause = Cause::kNone;
  std::uint16_t code = 0;
  Reply reply;                 // when done
  std::vector<Bytes> sent;     // every request
  std::vector<Bytes> answers;  // what came after each
  // A value, or a device's refusal: what a disturbed answer must not turn into.
  [[nodiscard]] bool says_something() const {
    return done || cause == Cause::kDeviceError || cause == Cause::kDeviceBusy;
  }
  [[nodiscard]] bool same_as(const RunOutcome& other) const;
  [[nodiscard]] std::string text() const;
};

// A subject's device on a line of its own.
class LiveDevice {
 public:
  explicit LiveDevice(const Subject& subject, const BusFaults& faults = {});
  [[nodiscard]] RunOutcome run(std::unique_ptr<Exchange> exchange);
  [[nodiscard]] SimDevice& device() { return *bus_->members()[0].device; }
  [[nodiscard]] Instant now() const { return now_; }

 private:
  const LineFormat line_format_;
  std::unique_ptr<SimBus> bus_;
  std::unique_ptr<BusLine> line_;
  Instant now_{};
};

// answers[n] comes after the n-th send, in pieces that end at `cuts`; afterwards silence.
[[nodiscard]] RunOutcome replay(std::unique_ptr<Exchange> exchange, const LineFormat& line,
                                std::span<const Bytes> answers,
                                std::span<const std::size_t> cuts = {});

}  // namespace fieldcast::sim
