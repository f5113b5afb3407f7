/// @file
/// The state of bridges, buses and devices, as they report it once a second and at every change.
/// Plain values; any thread.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "fieldcast/values.hpp"

namespace fieldcast::api {
inline namespace v1 {

/// Number of failures for each cause that occurred: {"CHECKSUM": 3}.
using Causes = std::map<std::string, std::uint64_t>;

struct BusStatus {
  std::string bridge, bus;
  std::string state;        ///< "opening", "running", "closed", "leased" or "stopped"
  double utilisation = 0;   ///< share of the last second in which the wire was in use, 0..1
  double planned_load = 0;  ///< share that the read plan needs
  std::uint64_t exchanges = 0, samples = 0, commands = 0, missed_refreshes = 0;
  Causes causes;  ///< of failed exchanges
  Time reported_at;
  bool present = true;  ///< false: the bridge has left the domain
};

struct DeviceStatus {
  std::string bus, device;
  std::string state;  ///< "unknown", "online", "degraded" or "offline"
  std::uint64_t exchanges = 0, failures = 0, retries = 0, missed_refreshes = 0;
  Duration response_time{};
  std::vector<std::string> refused;  ///< addresses that the device refuses at present
  Causes causes;
  Time reported_at;
  bool present = true;
};

struct Bridge {
  std::string bridge, host, version, standby_group;
  std::vector<std::string> buses;  ///< that it serves
  Time since;
  bool present = true;
};

}  // namespace v1
}  // namespace fieldcast::api
