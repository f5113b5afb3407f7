// The running bridge: assembles the parts, connects DDS with the buses, and starts and stops all of
// them in order. Call the functions on the main thread. Threads of the guard and the roles lock
// `changing_`; threads of DDS and the programming server enter through the handlers in
// bridge_wiring.cpp.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/alarm/alarm_table.hpp"
#include "bridge/base/io_thread.hpp"
#include "bridge/buses/bus_set.hpp"
#include "bridge/buses/reload_plan.hpp"
#include "bridge/calculate/input_relay.hpp"
#include "bridge/command/command_service.hpp"
#include "bridge/dds/endpoints/dds_link.hpp"
#include "bridge/history/history_service.hpp"
#include "bridge/interest/interest_registry.hpp"
#include "bridge/metrics/metrics_server.hpp"
#include "bridge/metrics/metrics_snapshot.hpp"
#include "bridge/port/dial_in_registry.hpp"
#include "bridge/program/server.hpp"
#include "bridge/publish/audit_publisher.hpp"
#include "bridge/publish/publisher_thread.hpp"
#include "bridge/role/membership.hpp"
#include "bridge/service/service.hpp"
#include "bridge/standby/bus_guard.hpp"
#include "bridge/standby/master_lease.hpp"
#include "bridge/standby/role_thread.hpp"
#include "bridge/store/command_audit.hpp"
#include "bridge/store/command_id_table.hpp"
#include "bridge/store/store.hpp"
#include "bridge/store/users/authenticator.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

class Bridge {
 public:
  // Receives requests about the configuration, on DDS threads; see DdsLink::Handlers.
  using OnConfiguration =
      std::function<void(ConfigurationMessage request, std::string subject, std::string fault)>;
  explicit Bridge(OnConfiguration on_configuration = {});
  ~Bridge() { stop(); }
  Bridge(const Bridge&) = delete;
  Bridge& operator=(const Bridge&) = delete;

  // Joins the DDS domain and starts every bus. A missing port is not an error: its bus waits for
  // it. Fails with the reason of DDS, one line. With thousands of channels this lasts seconds:
  // `give_up` is called before each bus, and if it returns true, no further bus is started.
  [[nodiscard]] tl::expected<void, std::string> start(
      const BridgeSpec& spec, const std::function<bool()>& give_up = [] { return false; });

  // Restarts only the buses that differ; after an error nothing has changed. REQUIRES: started.
  struct Reloaded {
    // Programming sessions that the reload would end: "line/plc by anna (10.0.0.7:51234)". If not
    // empty, nothing was reloaded; try again later.
    std::vector<std::string> waits_for;
  };
  [[nodiscard]] tl::expected<Reloaded, std::string> reload(const BridgeSpec& wanted);
  // The other members have removed this bridge; the next reload joins the domain again.
  void was_removed() {
    const std::lock_guard lock(changing_);
    removed_ = true;
  }
  [[nodiscard]] BridgeSpec configuration() const {
    const std::lock_guard lock(changing_);
    return spec_;
  }
  // False if a reload failed and the previous configuration could not be started again either. The
  // next reload then starts what it is given.
  [[nodiscard]] bool is_running() const;

  void set_trace(bool on);

  // For the configuration, on any thread. They wait for the end of a reload; without effect if the
  // bridge is not in its domain.
  void respond(const ConfigurationMessage& reply);
  void note(AuditEntry entry) { audit_.note(std::move(entry)); }
  // The last quality of each channel that is read at least each `kSoon`; of others, if they were
  // read. In a standby group only of served buses. Empty if the bridge is not in its domain.
  static constexpr Duration kSoon = std::chrono::seconds{10};
  [[nodiscard]] std::optional<std::map<std::string, Quality>> qualities() const;

  // Reads first values of devices that are not configured; see BusRunner::probe(). Returns false if
  // the bus does not run here. Any thread; waits for the end of a reload.
  [[nodiscard]] bool probe(const std::string& bus, DeviceProbe probe, BusRunner::Probed done);

  // Last turn of each bus's io thread (BusRunner::last_turn).
  [[nodiscard]] std::vector<BusTurn> turns() const;

  // Responds to every pending command and disposes every instance, in less than two seconds.
  void stop();

  // For the thread that ends the process when the main thread hangs. busy_with() returns what the
  // main thread does. save() writes the pending data of the store, as far as the limit allows.
  [[nodiscard]] std::string busy_with() const { return step_.load(); }
  void save(Duration limit);

 private:
  using Modules = program::Server::Modules;
  using Started = tl::expected<void, std::string>;
  struct OpenStore {
    OpenStore(const StoreSpec& spec, AlarmTable& alarms);
    Store store;
    Authenticator logins;
    CommandIdTable identities;
  };

  // `modules`: what happens to connected modules if the start fails, or at the stop.
  [[nodiscard]] Started start_all(const BridgeSpec& wanted, Modules modules,
                                  const std::function<bool()>& give_up);
  void stop_all(Modules modules, DdsLink::Leave leave = DdsLink::Leave::kDispose);
  [[nodiscard]] bool follow_role();
  void restart_as_standby();

  [[nodiscard]] Started start_anew(const BridgeSpec& wanted, const ReloadPlan& plan);
  [[nodiscard]] Started exchange_buses(const BridgeSpec& wanted, const ReloadPlan& plan);
  void configure_alarms(const BridgeSpec& from, const BridgeSpec& to);

  // bridge_wiring.cpp. join() throws DdsError.
  void join();
  [[nodiscard]] DdsLink::Handlers link_handlers();
  [[nodiscard]] BusGuard::Handlers guard_handlers();
  [[nodiscard]] program::Hooks program_hooks();
  void publish_alarms();
  void serve_metrics(const BridgeSpec& wanted);

  std::atomic<const char*> step_ = "starting";  // what the main thread does now
  mutable std::mutex changing_;                 // held while the set of buses changes
  std::atomic<bool> leaving_ = false;           // stop() has begun
  std::atomic<bool> readers_came_ = false;      // see Membership
  const OnConfiguration on_configuration_;
  bool removed_ = false;    // see was_removed()
  std::mutex store_mutex_;  // guards the pointer `store_` from save()
  BridgeSpec spec_;
  bool trace_ = false;

  // Parts that outlive a restart with a new configuration. Each uses only parts above it.
  CommandAudit audit_;
  CommandRouter router_;
  AlarmTable alarms_;
  InputRelay inputs_;
  InterestRegistry interests_;
  DialInRegistry modules_;
  program::Server program_;
  MetricsTable figures_;
  MasterLease lease_;  // always held by a bridge without a group
  RoleThread roles_;
  CommandService commands_;
  IoThread plans_{"plans"};
  PublisherThread sinks_;
  Membership::Memory memory_;

  // Parts in the domain. Each uses only parts above it, except the handlers of guard and link.
  std::unique_ptr<BusGuard> guard_;
  std::unique_ptr<DdsLink> link_;
  std::unique_ptr<HistoryService> history_;
  std::atomic<HistoryService*> receives_history_ = nullptr;  // history_, while link_ can respond
  std::unique_ptr<OpenStore> store_;                         // only with `store`
  std::unique_ptr<AuditPublisher> published_audit_;
  std::unique_ptr<BusSet> buses_;
  std::unique_ptr<Membership> membership_;  // only in a standby group
  std::unique_ptr<MetricsServer> metrics_;  // only with `metrics`
};

// "2 buses, DDS domain 0"
[[nodiscard]] std::string buses_text(const BridgeSpec& spec);

}  // namespace fieldcast
