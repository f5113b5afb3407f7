/// @file
/// The state of bridges, buses and devices, as they report it once a second and at every change,
/// the read plans of buses, and the sessions of engineers. Plain values; any thread.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
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

/// What a bus reads, when, and how much of the wire this needs.
struct ReadPlan {
  /// Consecutive items of a device that are read together.
  struct Point {
    std::string area;  ///< "holding"
    std::uint32_t first = 0, count = 0;
    std::vector<std::string> channels;  ///< names on the device
    Duration period{}, phase{};         ///< 0: it is not in the timetable
    std::optional<Duration> worst_gap;  ///< between two readings, as planned
    double stretch = 1;                 ///< factor on its refresh while the wire is overloaded
  };
  /// Points that are read with the same requests.
  struct Group {
    std::string device;
    bool list = false;           ///< a request contains a list of ranges
    Duration period{}, phase{};  ///< 0: it is not in the timetable
    Duration slack{};            ///< how much a read may end earlier than its phase
    double load = 0;             ///< share of the wire
    std::vector<Point> points;   ///< ordered by area and address
  };
  std::string bus;
  double load = 0;                 ///< share of the wire that the plan needs
  double stretch = 1;              ///< the largest of all points
  Duration slot{}, hyperperiod{};  ///< 0: the plan has no timetable
  std::vector<Group> groups;
  Time in_force_since;
  bool present = true;  ///< false: the bridge has left the domain
};

/// The session of an engineer who programs a device through the bridge.
struct ProgrammingSession {
  std::string bus, device;  ///< a module without a bus: "dial-in" and its device number
  std::string state;        ///< "open", "closed" or "refused"
  std::string engineer;     ///< the user and the network address, or the address alone
  std::uint64_t bytes_to_device = 0, bytes_from_device = 0;
  Time since;
  bool present = true;
};

}  // namespace v1
}  // namespace fieldcast::api
