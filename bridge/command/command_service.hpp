// Commands and alarm actions of the bridge, from their arrival to their single result. A waiting
// member of a standby group holds them; the master notes at the other members which writes begin; a
// new master responds for a lost one. Any thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "bridge/alarm/alarm_actions.hpp"
#include "bridge/command/command_router.hpp"
#include "bridge/dds/endpoints/dds_link.hpp"
#include "bridge/standby/held_commands.hpp"
#include "bridge/standby/master_lease.hpp"
#include "bridge/standby/role_thread.hpp"
#include "bridge/standby/standby_group.hpp"
#include "bridge/store/command_audit.hpp"
#include "bridge/store/command_id_table.hpp"
#include "core/alarm/alarm_status.hpp"
#include "core/model/command.hpp"

namespace fieldcast {

class CommandService {
 public:
  // All references must outlive this object.
  CommandService(CommandRouter& router, CommandAudit& audit, AlarmTable& alarms,
                 const MasterLease& lease, RoleThread& roles,
                 AlarmActions::EndSession end_session = {})
      : router_(router),
        audit_(audit),
        actions_(alarms, audit, std::move(end_session)),
        lease_(lease),
        roles_(roles) {}

  // Call join() first, only in a standby group. They outlive close(). `identities` may be null.
  void join(StandbyGroup& group);
  void open(DdsLink& link, CommandIdTable* identities);
  // REQUIRES: no handler of the link, the group or the identities is called any more.
  void close();

  // ---- from plant systems and buses

  // The steps of a command at the bridge, after DdsLink has received it and authenticated its
  // requester. The first step that returns a result ends the way.
  //   hold          at a waiting member, until the master responds     (HeldCommands)
  //   deduplicate   each pair of requester and request_id runs once    (CommandRouter)
  //   note          a write, at other members and in the store (StandbyGroup, CommandIdTable)
  //   route         to the bus                                         (CommandRouter)
  //   execute       the request and its response on the wire           (BusEngine)
  //   respond       with the result, unless keeps_result()             (BusOutput)
  // `late`: the command has already expired; the text is the reason.
  void receive(const std::string& bus, Command command, std::string late = {});
  void receive(const AlarmAction& action);
  // Returns true if this bridge must not publish the result: the successor runs the command, or the
  // master is not known at this moment.
  [[nodiscard]] bool keeps_result(const std::string& bus, const CommandResult& result);

  // Results of the gateway's commands on this bus are also passed to `done`, which must not block
  // or call this object; empty: no more. After the return, no earlier `done` is called.
  using Done = std::function<void(const CommandResult&)>;
  void set_gateway(const std::string& bus, Done done);
  // Passes a result to the gateway. Returns true if nobody else gets it: the result of a read.
  [[nodiscard]] bool is_of_gateway(const std::string& bus, const CommandResult& result);

  // ---- from other bridges of the group

  // A response of another bridge, seen as its result or reported by the master.
  void seen_result(const std::string& requester, std::uint64_t request_id);
  void note(const StandbyNote& note);             // StandbyGroup::Handlers::noted
  void resolve_unknown(const StandbyNote& held);  // StandbyGroup::Handlers::held

  // ---- changes of the role, in this order; on the thread of roles

  // Runs the commands that the old master has not started.
  void run_held();
  // Waits for the results of commands that the old master had started; they may still arrive.
  void finish_begun();
  // Publishes the results that were kept, if this bridge is still master.
  void finish_late();
  [[nodiscard]] bool has_late();
  // From now on, commands belong to the successor. Waits for running ones, at most `limit`.
  void hand_over(Duration limit);
  [[nodiscard]] bool is_handing_over() const { return handing_over_; }
  // The successor responds to the commands that are left.
  void handed_over();
  // At a waiting member: reports held commands that the master may not have received. `leaving`:
  // all of them, because this member may have been the only one that a plant system had discovered.
  void report_held(bool leaving);

 private:
  struct Held {
    std::string bus;
    Command command;
  };
  // Publishes a final result, also to the gateway.
  void publish(const std::string& bus, const CommandResult& result);
  void run_noted(const std::string& bus, const Command& command, Instant received);
  void run(const AlarmAction& action);
  void respond(const std::string& bus, const CommandResult& result);
  [[nodiscard]] bool keep_late(const std::string& bus, const CommandResult& result);
  void note_result(const std::string& requester, std::uint64_t request_id);
  [[nodiscard]] bool has_result(const std::string& requester, std::uint64_t request_id);

  CommandRouter& router_;
  CommandAudit& audit_;
  AlarmActions actions_;
  const MasterLease& lease_;
  RoleThread& roles_;
  // They change only while no handler is called.
  DdsLink* link_ = nullptr;
  StandbyGroup* group_ = nullptr;
  CommandIdTable* identities_ = nullptr;

  HeldCommands<Held> held_commands_;
  HeldCommands<AlarmAction> held_actions_;
  std::atomic<int> in_hand_{0};  // in a group: commands that run here and have no result yet
  std::atomic<bool> handing_over_ = false;
  std::mutex late_mutex_;
  // Results that arrived while the lease was not held.
  std::vector<std::pair<std::string, CommandResult>> late_;
  std::mutex gateways_mutex_;
  std::map<std::string, Done, std::less<>> gateways_;
  std::mutex with_result_mutex_;
  RecentCommands with_result_{HeldCommands<Held>::kResultsFor};
};

}  // namespace fieldcast
