// Metrics of one moment: the last reports and the counters of the store. Immutable. Any thread.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bridge/dds/endpoints/dds_link.hpp"
#include "bridge/dds/guard/rtps_message.hpp"
#include "bridge/store/store.hpp"
#include "core/alarm/alarm_registry.hpp"
#include "core/base/time.hpp"
#include "core/gateway/client_session.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

struct BusFigures {
  std::string bus;
  BusReport report;
  DdsLink::BusCounters dds;
  UtcTime at;
  Instant reported{};  // the same moment
};

struct DeviceFigures {
  std::string bus, device;
  DeviceReport report;
};

// Only of a bus with a gateway.
struct GatewayFigures {
  std::string bus;
  gateway::Counters counters;
};

// Only of a bridge in a standby group.
struct StandbyFigures {
  bool master = false, ready = false;
  std::uint32_t term = 0;
  std::uint64_t takeovers = 0;
  std::uint64_t behind = 0;  // blocks of the master that this bridge has not applied yet
};

struct MetricsSnapshot {
  std::string bridge;
  std::vector<std::shared_ptr<const BusFigures>> buses;
  std::vector<std::shared_ptr<const DeviceFigures>> devices;
  std::vector<GatewayFigures> gateways;
  std::optional<AlarmCounts> alarms;
  std::optional<StoreCounters> store;
  std::optional<StandbyFigures> standby;
  RtpsFaultCounts refused_datagrams{};          // by all guards of this process
  std::optional<std::uint32_t> receive_buffer;  // bytes, of a UDP socket; `std::nullopt`: unknown
};

// Returns the fault of a bus without a report for this time, as "line: no report for 17 s"; empty
// if all buses report. Each bus reports every second; the limit is that of the watchdog of systemd.
inline constexpr Duration kSilentBus = std::chrono::seconds{15};
[[nodiscard]] std::string silent_bus(const MetricsSnapshot& snapshot, Instant now);

// Last report of every bus and device, for the metrics, as immutable copies that a snapshot shares:
// the lock is held only to copy pointers. Any thread. Limited by the number of buses and devices.
class MetricsTable {
 public:
  void note(BusFigures figures);
  void note(DeviceFigures figures);
  void note(GatewayFigures figures);
  // Removes a stopped bus and its devices. REQUIRES: no note() of this bus follows.
  void remove(std::string_view bus);

  // Adds the buses and devices to the snapshot, sorted by name.
  void copy_to(MetricsSnapshot& snapshot) const;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<const BusFigures>, std::less<>> buses_;
  std::map<std::pair<std::string, std::string>, std::shared_ptr<const DeviceFigures>> devices_;
  std::map<std::string, GatewayFigures, std::less<>> gateways_;
};

}  // namespace fieldcast
