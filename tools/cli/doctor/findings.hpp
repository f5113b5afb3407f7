// Facts about a machine for `fieldcast doctor`. Plain values.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/capture/capture_folder.hpp"
#include "core/base/time.hpp"

namespace fieldcast::cli {

struct AdapterFacts {
  std::string name;                  // "ttyUSB0"
  std::string driver;                // "ftdi_sio"; empty: unknown
  std::optional<int> latency_timer;  // ms; only FTDI drivers have one
  std::string latency_file;          // file that sets it
};

struct SerialPortFacts {
  std::string bus;
  std::string path;
  bool there = false;
  bool readable_and_writable = false;  // by `user`
  std::string group;                   // that may open it
  std::string user = {};               // empty: the current user
};

struct InterfaceFacts {
  std::string address;     // IPv4
  std::string name;        // "eth0"; empty: no interface of this machine has the address
  bool multicast = false;  // a socket can receive it there
  bool loopback = false;
};

struct DiskFacts {
  std::string path;    // file of the store
  std::string folder;  // its directory, which may not exist yet
  bool folder_there = true;
  std::uint64_t free_bytes = 0;
};

// `max_instances` of a reader or writer in the configured Fast DDS profile.
struct ProfileLimit {
  std::string profile;  // "fieldcast/Sample"
  std::int64_t max_instances = 0;
};

// The clock of a bridge, as heard in the domain.
struct ClockFacts {
  std::string bridge;
  Duration ahead{};  // this machine's clock minus the bridge's
  UtcTime here;      // this machine's clock when the bridge was heard last
};

// Facts that cannot be read have no finding.
struct MachineFacts {
  std::uint64_t receive_buffer_asked = 0;             // requested by each of our sockets, bytes
  std::optional<std::uint64_t> receive_buffer_limit;  // net.core.rmem_max, bytes
  std::vector<AdapterFacts> adapters;
  std::optional<bool> clock_synchronised;

  std::string profile_file;  // Fast DDS profile; empty: none
  std::vector<ProfileLimit> profile_limits;
  std::vector<SerialPortFacts> ports;
  std::vector<InterfaceFacts> interfaces;  // configured for DDS
  bool discovery_server = false;
  std::optional<DiskFacts> disk;        // for a store in a file
  std::vector<CaptureRemark> captures;  // faults of the capture directories
  std::size_t channels = 0;
  std::vector<ClockFacts> clocks;  // of bridges in its domain
  std::string clocks_unknown;      // why the domain could not be joined; empty: it could
};

enum class Severity : std::uint8_t {
  kOk,        // checked and correct
  kAdvice,    // works, but slower or less reliably than possible
  kPrevents,  // part of the configuration cannot run
};
[[nodiscard]] std::string_view severity_text(Severity severity);  // "ok", "advice", "prevents"

struct Finding {
  Severity severity = Severity::kOk;
  std::string check;  // "receive buffer"
  std::string where;  // file, port or address; may be empty
  std::string what;
  std::string remedy;  // command or change that fixes it; empty: none
  friend bool operator==(const Finding&, const Finding&) = default;
};

// In the order of the checks; unknown facts have no finding.
[[nodiscard]] std::vector<Finding> findings_of(const MachineFacts& facts);

[[nodiscard]] Severity worst_of(const std::vector<Finding>& findings);

}  // namespace fieldcast::cli
