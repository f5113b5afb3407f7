// A station for one command: all callbacks put events in one inbox, which the main thread reads.
// Ctrl-C closes the inbox and ends every wait.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "bridge/base/bounded_queue.hpp"
#include "bridge/station/sites.hpp"
#include "tools/cli/domain/connection.hpp"
#include "tools/cli/model/catalogue.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/view/status/status_facts.hpp"

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

// Bus of the event; empty if it has none.
[[nodiscard]] std::string_view bus_of(const DomainEvent& event);

// Returns true if the event names a bus or device for the first time.
bool update(StatusModel& model, const DomainEvent& event);

class DomainView {
 public:
  // Beyond this the oldest event is dropped and counted.
  static constexpr std::size_t kMaxWaiting = 65536;

  // Joins the domain. Throws DdsError.
  DomainView(const Connection& connection, Interrupt& interrupt);
  ~DomainView();
  DomainView(const DomainView&) = delete;
  DomainView& operator=(const DomainView&) = delete;

  // Call each at most once.
  void subscribe_channels();
  void subscribe_samples();
  void subscribe_status();
  void subscribe_results();
  // Also subscribes the bus status, which shows that a bridge exists.
  void subscribe_program_sessions();
  void subscribe_alarms();  // with the actions of operators

  [[nodiscard]] Sites& station() { return station_; }
  [[nodiscard]] std::vector<std::string> missing_servers() const {
    return station_.missing_servers();
  }
  [[nodiscard]] BoundedQueue<DomainEvent>& inbox() { return inbox_; }
  [[nodiscard]] bool interrupted() const { return interrupt_.raised(); }

 private:
  Interrupt& interrupt_;
  // Before the station, because its threads write here until it is destroyed.
  BoundedQueue<DomainEvent> inbox_{kMaxWaiting};
  Sites station_;
};

}  // namespace fieldcast::cli
