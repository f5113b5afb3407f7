// A station's end of the domain with everything that the pages need of it: what is known now, the
// clients of /live, commands and interests. Owns its DDS participant.
//
// Made and destroyed while the io thread does not run, or on it; everything else on the io thread.
// The context, the audit and the tap outlive it.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "bridge/station/sites.hpp"
#include "bridge/store/audit.hpp"
#include "tools/station/live/command_desk.hpp"
#include "tools/station/live/domain_inbox.hpp"
#include "tools/station/live/live_hub.hpp"
#include "tools/station/live/live_model.hpp"
#include "tools/station/live/live_peer.hpp"

namespace fieldcast::web {

// For whoever wants each sample, not the newest alone: a recorder. Called on DDS threads, must not
// block. Those that are null are not called.
struct DomainTap {
  std::function<void(const StationChannel&)> channel;
  Station::OnGone gone;  // of a channel
  std::function<void(const StationSample&)> sample;
  std::function<void(const StationDeviceStatus&)> device_status;
  std::function<void(const StationAlarm&)> alarm;
  std::function<void(const StationAlarmStatus&)> alarm_status;
};

class LiveDomain {
 public:
  // Joins the domain, or those of several sites. `name` is the station's; `version` the program's.
  // Throws DdsError.
  LiveDomain(boost::asio::io_context& io, const std::vector<DdsSite>& sites,
             const std::string& name, const std::string& version, Audit* audit = nullptr,
             DomainTap tap = {});
  ~LiveDomain();
  LiveDomain(const LiveDomain&) = delete;
  LiveDomain& operator=(const LiveDomain&) = delete;

  [[nodiscard]] const LiveModel& model() const;
  [[nodiscard]] CommandDesk& commands();
  [[nodiscard]] LiveHub& hub();
  // For the server: a protocol for each WebSocket. They go before this object.
  [[nodiscard]] MakeLiveProtocol make_protocol();

  struct Counters {
    DomainInbox::Counters inbox;
    LiveModel::Counters model;
    FrameBook::Counters frames;
    LiveClient::Counters clients;
    Station::BlockCounters blocks;
    std::size_t channels = 0, connected = 0, interests = 0;
  };
  [[nodiscard]] Counters counters() const;
  // Discovery servers that do not answer.
  [[nodiscard]] std::vector<std::string> missing_servers() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast::web
