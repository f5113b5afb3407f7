// This bridge as a member of its standby group, from joining to leaving: messages, the state of the
// master that it follows, and what starts and stops when its role changes. Owns the election, its
// DDS endpoints and the follower. On the thread that changes the set of buses, except where stated.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "bridge/alarm/alarm_table.hpp"
#include "bridge/buses/bus_set.hpp"
#include "bridge/command/command_service.hpp"
#include "bridge/dds/endpoints/dds_link.hpp"
#include "bridge/metrics/metrics_snapshot.hpp"
#include "bridge/standby/bus_guard.hpp"
#include "bridge/standby/election.hpp"
#include "bridge/standby/hand_over_pause.hpp"
#include "bridge/standby/master_lease.hpp"
#include "bridge/standby/role_thread.hpp"
#include "bridge/standby/standby_group.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

class StandbyChannel;
class StandbyFollower;

class Membership {
 public:
  // All outlive this object.
  struct Uses {
    DdsLink& link;
    BusGuard& guard;
    BusSet& buses;
    CommandService& commands;
    AlarmTable& alarms;
    MasterLease& lease;
    RoleThread& roles;
    std::atomic<bool>& readers_came;  // set when readers match or request missing data
  };
  // For the next membership of this process in the same group.
  struct Memory {
    std::string group;
    Election::Memory election;
    std::string not_ready;      // the last reason in the log why this bridge is not ready
    bool has_namesake = false;  // a bridge of the same name exists, which must not become master
  };
  // Throws DdsError. REQUIRES: `spec.standby`.
  Membership(const Uses& uses, const BridgeSpec& spec, const Memory& before);
  ~Membership();
  Membership(const Membership&) = delete;
  Membership& operator=(const Membership&) = delete;

  // Call when the buses are prepared.
  void take_part();
  void reconfigure(const BridgeSpec& spec);
  void set_not_ready(const std::string& reason) { group_->set_not_ready(reason); }

  enum class Next : std::uint8_t {
    kWait,     // for the next notification of the thread of roles
    kSoon,     // call follow_role() again soon
    kRestart,  // another bridge serves the buses: restart as a waiting member
  };
  // Carries out the role that the election has decided. `leaving`: the bridge is about to stop.
  [[nodiscard]] Next follow_role(bool leaving);
  [[nodiscard]] bool is_serving() const { return serves_.has_value(); }

  // Returns true if this bridge serves, or is_pausing().
  [[nodiscard]] bool needs_successor() const { return is_serving() || is_pausing(); }

  // Requests that any ready member becomes master; returns why not. Succeeds if this bridge is not
  // master any more, or is handing over already.
  [[nodiscard]] std::optional<std::string> hand_over();
  // Hands over, unless that has begun, and waits for the successor, while the thread of roles
  // continues. Returns false if no other bridge takes over. REQUIRES: follow_role() does not
  // restart any more.
  [[nodiscard]] bool hand_over_before_stop();
  // Returns true from the release of the buses to the restart that follows. Their instances belong
  // to the successor. REQUIRES: the bridge's lock.
  [[nodiscard]] bool is_pausing() const { return uses_.commands.is_handing_over(); }
  // Announces the end. Destroy this object when the link is closed.
  [[nodiscard]] Memory leave();

  [[nodiscard]] StandbyFigures figures() const;  // any thread
  [[nodiscard]] std::vector<std::string> others() const { return group_->view().others; }

 private:
  [[nodiscard]] StandbyGroup::Handlers group_handlers();
  void on_request(const StandbyRequest& request);
  void end_follower();
  void promote();
  void take_over_alarms(const std::vector<std::string>& taken,
                        const std::vector<StationAlarmStatus>& followed);
  void remain_master();
  void release();
  void look_for_namesake();
  void report_not_ready();

  const Uses uses_;
  const std::string name_;
  const std::int32_t strength_;
  const bool has_common_store_;
  Memory memory_;
  // Term of the samples of the buses that run here; `std::nullopt`: another bridge serves.
  std::optional<StandbyTerm> serves_;
  // Why it must not become master: a bridge of the same name was first; empty if none.
  std::string shadowed_ = "it has not looked";
  HandOverPause pause_;
  std::unique_ptr<StandbyGroup> group_;  // outlives the endpoints
  std::unique_ptr<StandbyChannel> channel_;
  std::mutex follower_mutex_;                  // guards the creation and the end of the follower
  std::unique_ptr<StandbyFollower> follower_;  // exists while another bridge of the group is master
};

}  // namespace fieldcast
