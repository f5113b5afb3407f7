// A bus of the plant. A SimBus owns the devices. A BusLine is the serial port or one TCP
// connection: it owns a Wire and a receiver of each device, and must not outlive its bus. Pure:
// bytes and instants in, bytes and instants out. Single-threaded.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/protocol/protocol.hpp"
#include "tools/sim/bus/wire.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {

struct LineStatistics {
  std::uint64_t bytes_received = 0, bytes_sent = 0;  // from the master, to the master
  std::uint64_t lost = 0;  // characters of a master that exceeded the queue
  std::uint64_t collisions = 0;
  std::uint64_t connections = 0;
  // From the end of a response to the master's next character.
  std::optional<Duration> shortest_rest;
};

class BusLine;

class SimBus {
 public:
  struct Member {
    std::string name;
    std::unique_ptr<SimDevice> device;
    FaultDice dice;
    std::uint64_t missed = 0;   // characters received while dead, busy or sending
    std::uint64_t spoiled = 0;  // responses suppressed or changed by faults
  };

  // Fails for a protocol without simulated devices or an invalid device specification.
  [[nodiscard]] static tl::expected<std::unique_ptr<SimBus>, std::string> make(
      const BusSpec& spec, const BusFaults& faults, std::uint64_t seed, Instant start);

  [[nodiscard]] std::unique_ptr<BusLine> open_line();

  [[nodiscard]] const BusSpec& spec() const { return spec_; }
  [[nodiscard]] const BusFaults& faults() const { return faults_; }
  [[nodiscard]] const std::vector<Member>& members() const { return members_; }
  [[nodiscard]] const LineStatistics& statistics() const { return statistics_; }
  [[nodiscard]] Instant start() const { return start_; }

 private:
  friend class BusLine;
  SimBus(const BusSpec& spec, const BusFaults& faults, std::uint64_t seed, Instant start);

  BusSpec spec_;
  BusFaults faults_;
  // A unit outside the configuration that a second master polls.
  struct Foreign {
    DeviceSpec spec;
    std::unique_ptr<Protocol> protocol;
    std::unique_ptr<SimDevice> device;
  };
  [[nodiscard]] tl::expected<void, std::string> make_foreign(const DeviceKind& kind);

  std::uint64_t seed_;
  Instant start_;
  Foreign foreign_;
  bool half_duplex_ = true;
  std::vector<Member> members_;
  LineStatistics statistics_;
};

class BusLine {
 public:
  BusLine(SimBus& bus, const WireOptions& options, std::uint64_t seed);
  // See Wire::from_master().
  void receive(ByteView bytes, Instant now, std::optional<std::uint32_t> response_baud = {});
  [[nodiscard]] Instant next_due() const;
  // Simulates until `now`; appends the bytes for the master.
  void advance(Instant now, Bytes& to_master);
  // The stream cannot be parsed further: close the connection.
  [[nodiscard]] bool hung_up() const { return hung_up_; }

 private:
  void deliver(const Passed& passed);
  void deliver(std::size_t device, std::uint8_t character, Instant end);
  void say(std::size_t device, Reaction& reaction, Instant at);
  void babble(Instant now);
  void plan_babble(Instant from);
  void plan_foreign(Instant from);
  void send_to_foreign(Instant now);
  [[nodiscard]] Instant silence_due() const;
  void be_silent(Instant at);
  [[nodiscard]] Instant unsolicited_due() const;
  void send_unsolicited(Instant at);

  SimBus& bus_;
  Wire wire_;
  std::vector<std::unique_ptr<Receiver>> receivers_;
  std::mt19937_64 random_;
  std::vector<Instant> spoke_until_;
  Instant next_babble_ = kNever, next_foreign_ = kNever;
  bool hung_up_ = false;
};

}  // namespace fieldcast::sim
