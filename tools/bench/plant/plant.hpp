#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/types.h>

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "bridge/station/station.hpp"

namespace fieldcast::bench {

// A port below the kernel's ephemeral ones. Throws std::runtime_error if all are in use.
[[nodiscard]] std::uint16_t free_port();

inline sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

[[nodiscard]] bool has_program(const std::string& program);

// A child process of a bench: starts it, measures it and always stops it by its id.
class Process {
 public:
  // Starts `program` from this executable's directory. Throws std::runtime_error.
  Process(const std::string& program, const std::vector<std::string>& arguments,
          const std::string& log_path);
  ~Process();  // calls stop()
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void stop();                               // SIGTERM, and SIGKILL after five seconds
  [[nodiscard]] double cpu_seconds() const;  // user and system
  [[nodiscard]] double resident_mb() const;
  [[nodiscard]] pid_t id() const { return id_; }

 private:
  pid_t id_ = -1;
};

[[nodiscard]] double resident_mb(pid_t process);
[[nodiscard]] double process_seconds();

// A temporary directory that is removed when this process ends, also by a signal.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }
  std::string write(const std::string& name, const std::string& text) const;

 private:
  std::string path_;
  int held_ = -1;       // open as long as this process lives
  pid_t remover_ = -1;  // removes the directory when held_ is closed
};

[[nodiscard]] bool wait_for_path(const std::string& path, double seconds);

[[nodiscard]] bool wait_for_text(const std::string& path, const std::string& text, double seconds);

// A probably unused DDS domain: 100..199 by the process id.
[[nodiscard]] unsigned own_domain();

struct Seen {
  std::uint64_t samples = 0;
  std::uint64_t bad = 0;
  std::int64_t last_acquired = 0;  // UTC nanoseconds
  std::int64_t longest_gap = 0;    // nanoseconds between acquisitions
  std::int64_t shortest_gap = INT64_MAX;
};

// A simulated plant and the bridge that reads it, as processes, and a station in this one.
class Plant {
 public:
  // `buses`: YAML list below `buses:`, with {dir} for serial links. `more`: further lines.
  Plant(const std::string& buses, const std::string& faults = {}, const std::string& more = {});

  // Waits for the serial links of all buses. Throws std::runtime_error if one does not appear.
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
  [[nodiscard]] auto seen() const { return copy(seen_); }  // by bus/device/channel
  [[nodiscard]] auto buses() const { return copy(buses_); }
  [[nodiscard]] auto devices() const { return copy(devices_); }  // by bus/device
  // Throws with the missing channels after `seconds`.
  void wait_until_seen(std::size_t channels, double seconds);

 private:
  template <class Value>
  Value copy(const Value& value) const {
    const std::lock_guard guard(lock_);
    return value;
  }

  ScratchFolder folder_;
  DdsSpec dds_;
  std::string config_;
  std::string faults_;
  std::vector<std::string> links_;  // of all buses
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

// YAML of one Modbus RTU bus on the serial link {dir}/NAME. `defaults`: content of its map.
[[nodiscard]] std::string serial_bus(const std::string& name, unsigned baud,
                                     const std::string& defaults, const std::string& devices,
                                     const char* format = "8E1");
// YAML below `devices:` with scattered holding registers (about every third one), by seed.
[[nodiscard]] std::string scattered_devices(int devices, int registers, unsigned seed);
// With contiguous registers in runs of `run`, each of which one request reads.
[[nodiscard]] std::string packed_devices(int devices, int registers, int run);

}  // namespace fieldcast::bench
