// A simulated plant and the bridge that reads it, as processes, and a station in this one.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "bridge/station/station.hpp"
#include "tools/bench/plant/process.hpp"

namespace fieldcast::bench {

struct Seen {
  std::uint64_t samples = 0;
  std::uint64_t bad = 0;
  std::int64_t last_acquired = 0;  // UTC nanoseconds
  std::int64_t longest_gap = 0;    // nanoseconds between acquisitions
  std::int64_t shortest_gap = INT64_MAX;
};

class Plant {
 public:
  // `buses`: YAML list below `buses:`, with {dir} for serial links. `more`: further lines.
  Plant(const std::string& buses, const std::string& faults = {}, const std::string& more = {});

  void start_simulator(const std::vector<std::string>& more = {});
  void start_bridge(const std::string& program = "fieldcast-bridge");
  void stop_bridge() { bridge_.reset(); }
  void stop_simulator() { simulator_.reset(); }
  void listen_to_status();  // with a station in this process
  void listen();            // to samples too

  [[nodiscard]] std::string link(const std::string& bus) const {
    return folder_.path() + '/' + bus;
  }
  [[nodiscard]] const ScratchFolder& folder() const { return folder_; }
  [[nodiscard]] unsigned domain() const { return dds_.domain; }
  [[nodiscard]] const std::string& config() const { return config_; }
  [[nodiscard]] Process& bridge() { return *bridge_; }
  [[nodiscard]] Station& station() { return *station_; }

  void forget_samples();                                   // starts a new measurement
  [[nodiscard]] std::map<std::string, Seen> seen() const;  // by bus/device/channel
  [[nodiscard]] std::map<std::string, StationBusStatus> buses() const;
  [[nodiscard]] std::map<std::string, StationDeviceStatus> devices() const;  // by bus/device
  // Throws with the missing channels after `seconds`.
  void wait_until_seen(std::size_t channels, double seconds);

 private:
  ScratchFolder folder_;
  DdsSpec dds_;
  std::string config_;
  std::string faults_;
  bool listening_ = false;
  std::unique_ptr<Process> simulator_;
  std::unique_ptr<Process> bridge_;
  mutable std::mutex lock_;
  std::map<std::string, Seen> seen_;
  std::map<std::string, StationBusStatus> buses_;
  std::map<std::string, StationDeviceStatus> devices_;
  std::unique_ptr<Station> station_;  // last member: its callbacks use the members above
};

// Waits in real time, the only wait in benches. Shows the remaining time on a terminal.
void let_run(double seconds);

// --seconds N of the command line, or the default.
[[nodiscard]] double seconds_from(int argc, char** argv, double by_default);

// YAML for `devices:` with scattered holding registers (about every third one), by seed.
[[nodiscard]] std::string scattered_devices(int devices, int registers, const std::string& indent,
                                            unsigned seed);
// With contiguous registers in runs of `run`, each of which one request reads.
[[nodiscard]] std::string packed_devices(int devices, int registers, const std::string& indent,
                                         int run);

}  // namespace fieldcast::bench
