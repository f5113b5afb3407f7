// Runs an exchange in virtual time with the engine's driver, against a device or given bytes.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/bus/wire/exchange_driver.hpp"
#include "tools/sim/bus/sim_bus.hpp"
#include "tools/sim/check/subject.hpp"

namespace fieldcast::sim {

struct RunOutcome {
  bool done = false;
  Cause cause = Cause::kNone;
  std::uint16_t code = 0;
  Reply reply;  // if done
  std::vector<Bytes> sent;
  std::vector<Bytes> answers;
  // True for a value or a device error: a disturbed response must not become one of these.
  [[nodiscard]] bool says_something() const {
    return done || cause == Cause::kDeviceError || cause == Cause::kDeviceBusy;
  }
  [[nodiscard]] bool same_as(const RunOutcome& other) const;
  [[nodiscard]] std::string text() const;
};

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

// Replays answers[n] after the n-th request, in pieces that end at `cuts`; afterwards silence.
[[nodiscard]] RunOutcome replay(std::unique_ptr<Exchange> exchange, const LineFormat& line,
                                std::span<const Bytes> answers,
                                std::span<const std::size_t> cuts = {});

}  // namespace fieldcast::sim
