// A protocol with one choice of its options, for the master and the simulated device.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/bus/wire/exchange_driver.hpp"
#include "core/model/bus_spec.hpp"
#include "tools/sim/bus/sim_bus.hpp"

namespace fieldcast::sim {

struct Subject {
  std::string variant;  // "mode: fins"; empty: no options
  DeviceSpec device;    // without channels
  PortSpec port;
  unsigned form = 0;    // of the responses of a declaration, if they have several
  bool checked = true;  // every response has a check: no flipped bit may be accepted
  std::span<const std::string_view> addresses{};  // built-in protocol: forms of its notation

  [[nodiscard]] LineFormat line() const { return line_of(port); }
  [[nodiscard]] std::unique_ptr<Protocol> protocol() const;
  [[nodiscard]] std::optional<Subject> neighbour() const;
};

// Returns one subject for each variant of a built-in protocol; empty for an unknown name.
[[nodiscard]] std::vector<Subject> subjects_of(std::string_view protocol);
[[nodiscard]] std::vector<Subject> subjects_of(const declared::SharedDeclaration& declaration);

struct RunOutcome {
  bool done = false;
  Cause cause = Cause::kNone;
  std::uint16_t code = 0;
  Reply reply;  // if done
  std::vector<Bytes> sent;
  std::vector<Bytes> responses;
  // True for a value or a device error: a disturbed response must not become one of these.
  [[nodiscard]] bool is_definite() const {
    return done || cause == Cause::kDeviceError || cause == Cause::kDeviceBusy;
  }
  [[nodiscard]] bool same_as(const RunOutcome& other) const;
  [[nodiscard]] std::string text() const;
};

[[nodiscard]] std::string frames(const std::vector<Bytes>& all);

// Runs an exchange in virtual time with the engine's driver, against a device or given bytes.
class LiveDevice {
 public:
  explicit LiveDevice(const Subject& subject, const BusFaults& faults = {});
  [[nodiscard]] RunOutcome run(std::unique_ptr<Exchange> exchange);
  // Of the next exchange on this connection; valid while this object lives.
  [[nodiscard]] ExchangeContext context(std::uint16_t sequence) { return {sequence, &session_}; }
  [[nodiscard]] const Bytes& session() const { return session_; }
  [[nodiscard]] SimDevice& device() { return *bus_->members()[0].device; }
  [[nodiscard]] Instant now() const { return now_; }

 private:
  const LineFormat line_format_;
  std::unique_ptr<SimBus> bus_;
  std::unique_ptr<BusLine> line_;
  Instant now_{};
  Bytes session_;
};

// Replays responses[n] after the n-th request, in pieces that end at `cuts`; afterwards silence.
[[nodiscard]] RunOutcome replay(std::unique_ptr<Exchange> exchange, const LineFormat& line,
                                std::span<const Bytes> responses,
                                std::span<const std::size_t> cuts = {});

}  // namespace fieldcast::sim
