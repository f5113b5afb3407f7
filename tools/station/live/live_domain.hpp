// The DDS side of the station: live model, clients of /live, commands and interests. Owns its DDS
// participants. Create, use and destroy it on the io thread, or while that does not run. `io`,
// `audit` and the tap must outlive it.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "bridge/station/station.hpp"
#include "bridge/store/records/records.hpp"
#include "tools/station/live/command_controller.hpp"
#include "tools/station/live/domain_inbox.hpp"
#include "tools/station/live/live_hub.hpp"
#include "tools/station/live/live_peer.hpp"
#include "tools/station/model/live_model.hpp"

namespace fieldcast::web {

// Receives each sample, for example to record it. Called on DDS threads; must not block. Null
// functions are skipped.
struct DomainTap {
  std::function<void(const StationChannel&)> channel;
  Station::OnGone gone;  // a channel was removed
  std::function<void(const StationSample&)> sample;
  std::function<void(const StationDeviceStatus&)> device_status;
  std::function<void(const StationAlarm&)> alarm;
  std::function<void(const StationAlarmStatus&)> alarm_status;
};

class LiveDomain {
 public:
  // Joins the domains of all sites. Throws DdsError.
  LiveDomain(boost::asio::io_context& io, const std::vector<DdsSite>& sites,
             const std::string& name, const std::string& version, Audit* audit = nullptr,
             DomainTap tap = {});
  ~LiveDomain();
  LiveDomain(const LiveDomain&) = delete;
  LiveDomain& operator=(const LiveDomain&) = delete;

  [[nodiscard]] const LiveModel& model() const;
  [[nodiscard]] CommandController& commands();
  [[nodiscard]] LiveHub& hub();
  // Creates the protocol of each WebSocket. They must be destroyed before this object.
  [[nodiscard]] MakeLiveProtocol make_protocol();

  struct Counters {
    DomainInbox::Counters inbox;
    LiveModel::Counters model;
    FrameCache::Counters frames;
    LiveClient::Counters clients;
    Station::BlockCounters blocks;
    std::size_t channels = 0, connected = 0, interests = 0;
  };
  [[nodiscard]] Counters counters() const;
  [[nodiscard]] std::vector<std::string> missing_servers() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast::web
