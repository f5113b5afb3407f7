// What `fieldcast doctor` knows of a machine. Plain values: gather.hpp reads them, findings.hpp
// judges them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bridge/capture/capture_check.hpp"
#include "core/base/time.hpp"

namespace fieldcast::cli {

// A serial adapter at the USB.
struct AdapterFacts {
  std::string name;                  // "ttyUSB0"
  std::string driver;                // "ftdi_sio"; empty: unknown
  std::optional<int> latency_timer;  // ms; FTDI's drivers alone have one
  std::string latency_file;          // where it is set
};

// A serial port that a bus of the configuration names.
struct SerialPortFacts {
  std::string bus;
  std::string path;
  bool there = false;
  bool readable_and_writable = false;  // by whoever asks
  std::string group;                   // that may open it
};

struct InterfaceFacts {
  std::string address;     // IPv4
  std::string name;        // "eth0"; empty: no interface of this machine has the address
  bool multicast = false;  // a socket gets it there
  bool loopback = false;
};

struct DiskFacts {
  std::string path;    // the store's file
  std::string folder;  // in which it is, or will be
  bool folder_there = true;
  std::uint64_t free_bytes = 0;
};

// `max_instances` of a reader or writer in the Fast DDS profile that the configuration names.
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

// Of what cannot be found out nothing is said.
struct MachineFacts {
  std::uint64_t receive_buffer_asked = 0;             // by each of our sockets, bytes
  std::optional<std::uint64_t> receive_buffer_limit;  // net.core.rmem_max, bytes
  std::vector<AdapterFacts> adapters;
  std::optional<bool> clock_synchronised;

  // With a configuration:
  std::string profile_file;  // its Fast DDS profile; empty: none
  std::vector<ProfileLimit> profile_limits;
  std::vector<SerialPortFacts> ports;
  std::vector<InterfaceFacts> interfaces;  // that DDS shall use
  bool discovery_server = false;
  std::optional<DiskFacts> disk;        // of a store that is a file
  std::vector<CaptureRemark> captures;  // what is wrong with the folders of captures
  std::size_t channels = 0;
  std::vector<ClockFacts> clocks;  // of bridges in its domain
  std::string clocks_unknown;      // why the domain could not be joined; empty: it could
};

}  // namespace fieldcast::cli
