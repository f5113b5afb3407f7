// Runs a bus engine and its simulated plant in virtual time, exactly reproducible by the seed. Owns
// the engine, the plant and their clock. Pure: no thread, no I/O.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "core/bus/bus_engine.hpp"
#include "tools/sim/bus/sim_bus.hpp"

namespace fieldcast::sim {

class VirtualBus {
 public:
  // Called for each action; for sends before it is executed, for others after.
  using Watcher = std::function<void(const Action&)>;

  std::function<void(ByteView)> on_received;

  // The plant starts at Instant{}; throws std::runtime_error if it cannot be simulated.
  VirtualBus(const BusSpec& spec, const BusFaults& faults, std::uint64_t seed,
             Watcher watcher = {});
  VirtualBus(const VirtualBus&) = delete;
  VirtualBus& operator=(const VirtualBus&) = delete;

  void run_until(Instant until);
  void feed(const BusEvent& event);  // at the current time
  // Received bytes reach the engine up to `longest` after their arrival, in order, as on a busy
  // machine or behind an adapter that collects bytes.
  void delay_received(Duration longest, std::uint64_t seed);
  void unplug();
  void plug();
  // Destroys the engine and creates a new one with `spec` and `opened` after `absence`. On a serial
  // line, pending responses reach the new engine; TCP gets a new connection. REQUIRES: not called
  // by the watcher; `spec` has the devices of the plant.
  void replace_engine(const BusSpec& spec, Duration absence, const Opened& opened = {});

  [[nodiscard]] Instant now() const { return now_; }
  [[nodiscard]] bool plugged() const { return line_ != nullptr; }
  [[nodiscard]] BusEngine& engine() { return *engine_; }
  [[nodiscard]] SimBus& plant() { return *plant_; }
  [[nodiscard]] Instant wire_free() const { return wire_free_; }
  // Hash of all events; equal in two runs only if they did the same.
  [[nodiscard]] std::uint64_t fingerprint() const { return fingerprint_; }

 private:
  void act(const Action& action);
  void receive();
  void send(ByteView bytes, std::uint32_t response_baud);
  void stamp(std::uint64_t what) { fingerprint_ = (fingerprint_ ^ what) * 1099511628211u; }

  BusSpec spec_;
  std::unique_ptr<SimBus> plant_;
  std::unique_ptr<BusLine> line_;
  std::optional<BusEngine> engine_;
  Watcher watcher_;
  Duration character_;
  Instant now_{};
  Instant timer_ = kNever;
  Instant reopen_at_ = kNever;
  Instant wire_free_{};
  Bytes received_;
  Duration longest_delay_{};
  std::mt19937_64 random_;
  Bytes delayed_;
  Instant delayed_until_ = kNever;
  std::vector<Actions> spare_;                        // feed() may be called by a watcher
  std::uint64_t fingerprint_ = 1469598103934665603u;  // FNV-1a
};

}  // namespace fieldcast::sim
