// A station for one command: all callbacks put events in one inbox, which the main thread reads.
// Ctrl-C closes the inbox and ends every wait.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "bridge/base/worker.hpp"
#include "bridge/station/standby_monitor.hpp"
#include "bridge/station/station.hpp"
#include "core/base/time.hpp"
#include "tools/cli/domain/connection.hpp"
#include "tools/cli/model/watch_model.hpp"
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

  [[nodiscard]] Station& station() { return station_; }
  [[nodiscard]] std::vector<std::string> missing_servers() const {
    return station_.missing_servers();
  }
  [[nodiscard]] BoundedQueue<DomainEvent>& inbox() { return inbox_; }
  [[nodiscard]] bool interrupted() const { return interrupt_.raised(); }

 private:
  // Callbacks that put their event in the inbox.
  auto put() {
    return [this](const auto& event) { inbox_.put_newest(event); };
  }
  auto put_gone() {
    return [this](const auto& bus, const auto& device, const auto& channel) {
      inbox_.put_newest(ChannelGone{{bus, device, channel}});
    };
  }

  Interrupt& interrupt_;
  // Before the station, because its threads write here until it is destroyed.
  BoundedQueue<DomainEvent> inbox_{kMaxWaiting};
  Station station_;
};

// Decides when all bridges have reported: nothing new for kQuietTime and a report of each site, or
// after kBridgeWait. Pure.
class Listening {
 public:
  Listening(const Connection& connection, Instant began);

  // Something new arrived for this bus (with sites: "site:bus").
  void news(std::string_view bus, Instant now);

  [[nodiscard]] bool anybody() const { return anybody_; }
  // For a bus without a known site: whether any bridge has reported.
  [[nodiscard]] bool heard_site_of(std::string_view bus) const;
  // End of the wait without further news.
  [[nodiscard]] Instant over_at() const;
  [[nodiscard]] Instant last_news() const { return last_news_; }
  [[nodiscard]] std::vector<std::string> silent_sites() const;
  // "no bridge found in site south"; empty with one site, or if all have reported.
  [[nodiscard]] std::string silent_text() const;

 private:
  struct Site {
    std::string name;  // empty: the only one
    bool heard = false;
  };
  [[nodiscard]] static bool is_of(const Site& site, std::string_view bus);

  std::vector<Site> sites_;
  Instant began_, last_news_;
  bool anybody_ = false;
};

// Receives standby messages in all domains of the connection, with its own participants.
// Thread-safe.
class StandbyWatch {
 public:
  // Throws DdsError.
  explicit StandbyWatch(const Connection& connection);

  [[nodiscard]] StandbyModel model();
  // Returns false after `end`, or when `give_up` returns true.
  [[nodiscard]] bool until(const std::function<bool(const StandbyModel&)>& condition, Instant end,
                           const std::function<bool()>& give_up);
  // Returns false if no bridge received the request within the limit.
  [[nodiscard]] bool request(const StandbyRequest& wanted, Duration limit);

 private:
  void learn(const StandbyMessage& message);

  std::mutex mutex_;
  std::condition_variable changed_;
  StandbyModel model_;
  std::vector<std::unique_ptr<StandbyMonitor>> sites_;  // last member: its callbacks call learn()
};

}  // namespace fieldcast::cli
