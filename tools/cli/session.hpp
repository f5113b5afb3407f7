// One command's time in the DDS domain: a station whose callbacks all end in one inbox, which the
// main thread reads.
//
// Main thread. Ctrl-C closes the inbox, so that no wait outlives it.
#pragma once

#include <string>
#include <variant>

#include "bridge/station/station.hpp"
#include "tools/cli/inbox.hpp"
#include "tools/cli/interrupt.hpp"
#include "tools/cli/model/catalogue.hpp"

namespace fieldcast::cli {

struct ChannelGone {
  ChannelPath path;
};
struct AlarmGone {
  StationAlarm last;
};
using SessionEvent =
    std::variant<StationChannel, StationSample, ChannelGone, StationBusStatus, StationDeviceStatus,
                 StationResult, ProgramSessionReport, StationAlarm, AlarmGone>;

class Session {
 public:
  // Joins the domain. Throws DdsError.
  Session(const DdsSpec& spec, Interrupt& interrupt);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // Each at most once.
  void hear_channels();
  void hear_samples();
  void hear_status();
  void hear_results();
  void hear_program_sessions();  // and bus status, which tells that a bridge is there
  void hear_alarms();

  [[nodiscard]] Station& station() { return station_; }
  [[nodiscard]] Inbox<SessionEvent>& inbox() { return inbox_; }
  [[nodiscard]] bool interrupted() const { return interrupt_.raised(); }

 private:
  Interrupt& interrupt_;
  Inbox<SessionEvent> inbox_;  // before the station: its threads write here until it is gone
  Station station_;
};

}  // namespace fieldcast::cli
