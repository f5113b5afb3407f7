// Simulates several masters and the devices of one bus on one half-duplex line, in virtual time and
// character by character. All receive all; overlapping characters are garbled.
//
// Each master is a whole BusEngine behind an adapter. The adapter can delay bytes, echo, be
// disconnected, or stop like a suspended process. Deterministic for a seed. Runs on the thread of
// the test; throws std::runtime_error if a device cannot be simulated.
#pragma once

#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "core/bus/bus_engine.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::test {

struct WireFaults {
  double noise = 0;  // random characters per second
  double late = 0;   // probability that a response is delayed by `late_by`
  Duration late_by = std::chrono::milliseconds{250};
  Duration answer_after = std::chrono::milliseconds{3};
};

struct Adapter {
  Duration latency{};  // delay of received bytes
  bool echo = false;
};

class SharedWire {
 public:
  struct Counts {
    std::uint64_t frames = 0;           // sent by masters
    std::uint64_t garbled = 0;          // frames with a character that overlapped another frame
    std::uint64_t garbled_answers = 0;  // of those: device frames that overlapped each other
    std::uint64_t turns = 0;            // frames that follow a frame of another master
    Duration shortest_turn = Duration::max();  // shortest silence before such a frame
  };
  struct Master {
    Master(const BusSpec& spec, const Adapter& behind) : engine(spec), adapter(behind) {}
    BusEngine engine;
    Adapter adapter;
    bool open = false, cut = false;
    std::vector<Bytes> not_sent;
    Instant stopped_until = kLongAgo;
    Instant timer = kNever;
    Bytes received;  // delayed in the adapter
    Instant deliver_at = kNever;
    Instant sends_until = kLongAgo;
    std::uint64_t frames = 0, answers = 0, good = 0, wrong = 0;
    Instant last_frame = kLongAgo, first_frame = kNever;
    std::vector<Notice> notices;
  };

  SharedWire(const BusSpec& spec, const std::vector<Adapter>& masters, const WireFaults& faults,
             std::uint64_t seed);

  void run_until(Instant until);
  void open(std::size_t master);   // the process starts and opens its port
  void close(std::size_t master);  // the process dies
  // Replaces the engine behind the adapter by a new, closed one; `rank` and `seed` as in
  // set_fence_order(). REQUIRES: not inside a callback.
  void replace(std::size_t master, unsigned rank, std::uint64_t seed);
  void feed(std::size_t master, const BusEvent& event);  // at the current instant
  void stop(std::size_t master, Duration time) { masters_[master]->stopped_until = now_ + time; }
  void cut(std::size_t master, bool off) { masters_[master]->cut = off; }

  // Returns whether a good value is correct. If empty, all are.
  std::function<bool(ChannelIndex, const Value&)> judge;
  // Returns whether this master may send and publish now. If empty, all may.
  std::function<bool(std::size_t)> may_send;
  // Called for each action of a master.
  std::function<void(std::size_t, const Action&)> on_action;
  // Called for each sent frame with its sender: a master, or -1 for a device.
  std::function<void(Instant, int, ByteView)> watch;

  [[nodiscard]] Instant now() const { return now_; }
  [[nodiscard]] const Counts& counts() const { return counts_; }
  [[nodiscard]] Master& master(std::size_t index) { return *masters_[index]; }
  [[nodiscard]] sim::SimDevice& device(std::size_t index) { return *devices_[index].device; }

 private:
  struct Device {
    std::unique_ptr<sim::SimDevice> device;
    std::unique_ptr<sim::Receiver> receiver;
    Instant sends_until = kLongAgo;
  };
  struct Transmission {
    int sender;  // index of a master; kDevices + index; kNoise
    Bytes characters;
    Instant start;
    std::size_t passed = 0;
    bool garbled = false;
    std::vector<bool> spoilt{};
    [[nodiscard]] Instant end_of(std::size_t index, Duration character) const {
      return start + character * static_cast<std::int64_t>(index + 1);
    }
  };
  static constexpr int kDevices = 100, kNoise = 1000;

  void transmit(int sender, ByteView characters, Instant start);
  void collide(Transmission& a, Transmission& b);
  void note_turn(std::size_t master, Instant start);
  void pass(Transmission& transmission);
  void to_devices(int sender, std::uint8_t character, Instant end);
  void to_masters(int sender, std::uint8_t character, Instant end);
  void react(std::size_t device, sim::Reaction& reaction, Instant at);
  void act(std::size_t master, const Action& action);
  [[nodiscard]] Instant silence_due() const;
  [[nodiscard]] Instant due_of(const Master& master) const;
  void serve(std::size_t master);
  void plan_noise();

  BusSpec spec_;
  WireFaults faults_;
  Duration character_;
  bool half_duplex_ = true;
  std::mt19937_64 random_;
  std::vector<std::unique_ptr<Master>> masters_;
  std::vector<Device> devices_;
  std::vector<Transmission> transmissions_;
  Instant now_{}, noise_at_ = kNever;
  Instant wire_silent_since_{};
  int last_master_ = -1;
  Counts counts_;
};

}  // namespace fieldcast::test
