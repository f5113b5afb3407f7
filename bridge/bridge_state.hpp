// The members of a running bridge, in the reverse order of their destruction. Private to Bridge.
// The functions are in five files: start and stop, wiring, the set of buses, reload, standby.
//
// Owns everything that Bridge owns. The functions run on the main thread, which holds `changing`.
// follow_guard() runs on the guard's thread and follow_role() on the thread of roles; both lock
// `changing` themselves. DDS threads and threads of the programming server enter through the
// handlers of bridge_wiring.cpp. join(), start_buses() and start_bus() throw DdsError; start() and
// reload() return its text.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/base/io_thread.hpp"
#include "bridge/bridge.hpp"
#include "bridge/bridge_roles.hpp"
#include "bridge/bus/bus_runner.hpp"
#include "bridge/capture/capture_service.hpp"
#include "bridge/alarm/alarm_actions.hpp"
#include "bridge/command/command_router.hpp"
#include "bridge/dds/endpoints/dds_link.hpp"
#include "bridge/dds/endpoints/standby_channel.hpp"
#include "bridge/dds/receivers/standby_follower.hpp"
#include "bridge/interest/interest_registry.hpp"
#include "bridge/log/log.hpp"
#include "bridge/metrics/metrics_server.hpp"
#include "bridge/metrics/metrics_snapshot.hpp"
#include "bridge/port/dial_in_registry.hpp"
#include "bridge/program/server.hpp"
#include "bridge/publish/bus_output.hpp"
#include "bridge/publish/publisher_thread.hpp"
#include "bridge/reload_plan.hpp"
#include "bridge/standby/bus_guard.hpp"
#include "bridge/standby/master_lease.hpp"
#include "bridge/standby/standby_group.hpp"
#include "bridge/store/command_audit.hpp"
#include "bridge/store/command_id_table.hpp"
#include "bridge/store/store.hpp"
#include "bridge/store/users/authenticator.hpp"

namespace fieldcast {

struct Bridge::State {
  BridgeSpec spec;
  bool trace = false;
  CommandAudit audit;
  CommandRouter commands;
  AlarmTable alarms;  // outlives the sinks and its use by the store
  AlarmActions alarm_actions{alarms, audit};
  InterestRegistry interests{[](const std::string& text) {
    log_counted(LogLevel::kInfo, "dds", "interests that change nothing", text);
  }};
  DialInRegistry modules;  // outlives the buses and the programming server
  program::Server program{program_hooks(), modules};
  // Guards `store`: other threads use it, and modules can connect during a full restart.
  std::mutex store_mutex;
  std::unique_ptr<Store> store;           // outlives the sinks of the buses; null without a store
  std::unique_ptr<Authenticator> logins;  // only with a store
  std::unique_ptr<CommandIdTable> identities;  // only with a store; closed before the link
  MetricsTable figures;                        // outlives the sinks
  MasterLease lease;  // outlives the sinks; always held by a bridge without a group
  Standby standby;
  IoThread plans{"plans"};
  std::unique_ptr<CaptureService> captures;  // exists while the bridge runs
  std::map<std::string, RunningBus, std::less<>> buses;
  PublisherThread sinks;
  // Contested buses that are already in the log; used by the guard's thread.
  std::set<std::string> contested;
  std::unique_ptr<BusGuard> guard;  // outlives the link; its thread ends before the buses
  std::unique_ptr<DdsLink> link;  // its handlers use the members above, so it is closed before them
  // Only with `metrics`; destroyed before the data that it reads.
  std::unique_ptr<MetricsServer> metrics;
  // Only in a standby group. They use the link and are destroyed before it.
  std::unique_ptr<StandbyChannel> channel;
  std::unique_ptr<StandbyFollower> follower;  // exists while another bridge of the group is master
  std::unique_ptr<StandbyGroup> group;

  std::atomic<const char*> step = "starting";  // what the main thread does now
  std::mutex changing;                         // held while the set of buses changes

  // bridge.cpp. `kept`: what happens to connected modules if the start fails, or at the stop.
  [[nodiscard]] tl::expected<void, std::string> start(
      const BridgeSpec& wanted, program::Server::Modules kept,
      const std::function<bool()>& give_up = [] { return false; });
  void stop_all(program::Server::Modules kept = program::Server::Modules::kLetGo,
                DdsLink::Leave leave = DdsLink::Leave::kDispose);
  [[noreturn]] void abandon(const std::string& bus);

  // bridge_wiring.cpp.
  [[nodiscard]] program::Hooks program_hooks();
  void join();
  void open_store();
  void serve_metrics(const BridgeSpec& wanted);
  void tell_other_bridges(DdsLink::Handlers& handlers);
  void publish_alarms();

  // bridge_buses.cpp.
  void want_buses(const BridgeSpec& wanted);
  [[nodiscard]] std::vector<std::string> running(std::vector<std::string> names) const;
  void start_buses(const std::vector<std::string>& names, const BridgeSpec& from);
  [[nodiscard]] bool follow_guard(const std::set<std::string>& uncontested);
  void start_bus(const BusSpec& bus, const FollowedBus* followed = nullptr,
                 std::uint64_t margin = 0);
  void take_over_alarms(const std::string& bus);
  void stop_buses(const std::vector<std::string>& names, Duration dispose_limit = Duration::max(),
                  DdsLink::Leave leave = DdsLink::Leave::kDispose);
  void stop_runners(const std::vector<std::string>& names);
  [[nodiscard]] RunningBus make_bus(const BusSpec& bus);

  // bridge_standby.cpp.
  void join_group();
  void stand_alone();
  void take_part();
  void prepare_bus(const BusSpec& bus);
  void on_request(const StandbyRequest& request);
  void leave_group();
  void end_follower();
  [[nodiscard]] bool hand_over_before_stop();
  [[nodiscard]] bool follow_role();
  void tell_last_words();
  void say_unheard(std::size_t bridges);
  void look_for_namesake();
  void say_not_ready();
  [[nodiscard]] bool late_results_done();
  void say_waits_for(const std::string& what);
  void promote();
  void remain_master();
  void release();
  void step_back();
  void start_as_standby();
  [[nodiscard]] StandbyFigures standby_figures() const;
  void take_over_followed_alarms(const std::vector<std::string>& taken,
                                 const std::vector<StationAlarmStatus>& followed);

  // bridge_group_commands.cpp.
  void run_held();
  void finish_begun();
  void tell_held();
  void answer_unknown(const StandbyNote& held);
  void seen_answer(const std::string& requester, std::uint64_t request_id);
  void answer_held(const std::string& bus, const CommandResult& result);
  void run_command(const std::string& bus, Command command, std::string late = {});
  void run_action(const AlarmAction& action);
  void run_noted(const std::string& bus, const Command& command, Instant received);
  [[nodiscard]] bool keeps_result(const std::string& bus, const CommandResult& result);
  [[nodiscard]] bool keep_late(const std::string& bus, const CommandResult& result);
  void finish_held();

  // bridge_reload.cpp.
  [[nodiscard]] tl::expected<Reloaded, std::string> reload(const BridgeSpec& wanted);
  [[nodiscard]] tl::expected<void, std::string> start_anew(const BridgeSpec& wanted,
                                                           const ReloadPlan& plan);
  [[nodiscard]] bool hand_over_for_renewal();
  [[nodiscard]] tl::expected<void, std::string> restart_program(const BridgeSpec& wanted);
  [[nodiscard]] tl::expected<void, std::string> exchange_buses(const BridgeSpec& wanted,
                                                               const ReloadPlan& plan);
  void configure_alarms(const BridgeSpec& from, const BridgeSpec& to);
};

}  // namespace fieldcast
