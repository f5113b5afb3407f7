// The DDS side of the station: live model, clients of /live, commands and interests. Owns its DDS
// participants. Create, use and destroy it on the io thread, or while that does not run. `io`,
// `audit` and the tap must outlive it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "bridge/station/station.hpp"
#include "bridge/store/records/records.hpp"
#include "tools/station/live/command_controller.hpp"
#include "tools/station/live/configuration_requests.hpp"
#include "tools/station/live/domain_inbox.hpp"
#include "tools/station/live/live_hub.hpp"
#include "tools/station/live/live_peer.hpp"
#include "tools/station/model/live_model.hpp"
#include "tools/station/record/back_filler.hpp"
#include "tools/station/record/recorder.hpp"

namespace fieldcast::web {

class LiveDomain {
 public:
  // Joins the domains of all sites. Throws DdsError. `audit` and `recorder` may be null, and must
  // outlive this object. `backfill` needs a recorder. `on_alarm` is called on threads of DDS and
  // must not block.
  LiveDomain(boost::asio::io_context& io, const std::vector<DdsSite>& sites,
             const std::string& name, const std::string& version, Audit* audit = nullptr,
             Recorder* recorder = nullptr, const std::optional<BackfillSpec>& backfill = {},
             std::function<void(const StationAlarmStatus&)> on_alarm = {});
  ~LiveDomain();
  LiveDomain(const LiveDomain&) = delete;
  LiveDomain& operator=(const LiveDomain&) = delete;

  [[nodiscard]] const LiveModel& model() const;
  [[nodiscard]] CommandController& commands();
  // Sends commands for sites of the stream by `route`, which must exist until commands().close().
  void set_stream(CommandRoute& route);
  [[nodiscard]] ConfigurationRequests& configurations();
  [[nodiscard]] LiveHub& hub();
  // For further sources of channels and values.
  [[nodiscard]] DomainInbox& inbox();
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
