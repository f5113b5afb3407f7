// One command's time in the DDS domain: a station whose callbacks all end in one inbox, which the
// main thread reads.
//
// Main thread. Ctrl-C closes the inbox, so that no wait outlives it.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "bridge/base/bounded_queue.hpp"
#include "bridge/station/sites.hpp"
#include "tools/cli/connection.hpp"
#include "tools/cli/interrupt.hpp"
#include "tools/cli/model/catalogue.hpp"
#include "tools/cli/view/status_facts.hpp"

namespace fieldcast::cli {

struct ChannelGone {
  ChannelPath path;
};
struct BusGone {
  std::string bus;
};
struct DeviceGone {
  std::string bus, device;
};
struct AlarmGone {
  StationAlarm last;
};
struct AlarmStatusGone {
  StationAlarmStatus last;
};
struct BridgeGone {
  std::string bridge;
};
using DomainEvent =
    std::variant<StationChannel, StationSample, ChannelGone, StationBusStatus, StationDeviceStatus,
                 StationResult, ProgramSessionReport, StationAlarm, AlarmGone, StationAlarmStatus,
                 AlarmStatusGone, BusGone, DeviceGone, StationBridge, BridgeGone>;

// What it is about; empty: no bus, or none that it names.
[[nodiscard]] std::string_view bus_of(const DomainEvent& event);

// Puts the status of a bus or a device and the claims of a bridge into the model, or removes them.
// Returns true when a bus or a device is named for the first time.
bool update(StatusModel& model, const DomainEvent& event);

class DomainView {
 public:
  // Events that may wait; then the oldest goes and is counted.
  static constexpr std::size_t kMaxWaiting = 65536;

  // Joins the domain. Throws DdsError.
  DomainView(const Connection& connection, Interrupt& interrupt);
  ~DomainView();
  DomainView(const DomainView&) = delete;
  DomainView& operator=(const DomainView&) = delete;

  // Each at most once.
  void subscribe_channels();
  void subscribe_samples();
  void subscribe_status();
  void subscribe_results();
  // Bus status comes too: it tells that a bridge is there.
  void subscribe_program_sessions();
  void subscribe_alarms();  // and what people did about them

  [[nodiscard]] Sites& station() { return station_; }
  [[nodiscard]] std::vector<std::string> missing_servers() const {
    return station_.missing_servers();
  }
  [[nodiscard]] BoundedQueue<DomainEvent>& inbox() { return inbox_; }
  [[nodiscard]] bool interrupted() const { return interrupt_.raised(); }

 private:
  Interrupt& interrupt_;
  // Before the station: its threads write here until it is gone.
  BoundedQueue<DomainEvent> inbox_{kMaxWaiting};
  Sites station_;
};

}  // namespace fieldcast::cli
