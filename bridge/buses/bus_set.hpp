// The buses of a bridge while it is in its domain: which of the configured ones it serves, and how
// they start and stop. Owns their threads, runners and outputs, and the captures. One thread at a
// time, except where stated otherwise.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bridge/base/io_thread.hpp"
#include "bridge/bus/bus_runner.hpp"
#include "bridge/capture/capture_service.hpp"
#include "bridge/command/command_router.hpp"
#include "bridge/dds/endpoints/dds_link.hpp"
#include "bridge/gateway/gateway_server.hpp"
#include "bridge/interest/interest_registry.hpp"
#include "bridge/port/dial_in_registry.hpp"
#include "bridge/program/server.hpp"
#include "bridge/publish/bus_output.hpp"
#include "bridge/service/service.hpp"
#include "bridge/standby/bus_guard.hpp"
#include "bridge/standby/standby_values.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

class BusSet {
 public:
  // All outlive the set. `step`: what the caller's thread does now, for the log of a hanging stop.
  struct Uses {
    BusOutput::Shared output;
    BusGuard& guard;
    CommandRouter& commands;
    InterestRegistry& interests;
    program::Server& program;
    DialInRegistry& modules;
    IoThread& plans;
    std::atomic<const char*>& step;
  };
  BusSet(const Uses& uses, const BridgeSpec& spec, bool trace);

  // Sets the configured buses. Starts and stops none of them.
  void want(const std::vector<BusSpec>& buses);
  [[nodiscard]] const std::vector<BusSpec>& wanted() const { return wanted_; }
  [[nodiscard]] std::vector<std::string> running() const;
  [[nodiscard]] std::vector<BusTurn> turns() const;
  void set_trace(bool on);
  void configure_captures();
  // See BusRunner::probe(). Returns false if the bus does not run here.
  [[nodiscard]] bool probe(const std::string& bus, DeviceProbe probe, BusRunner::Probed done);

  // Does every slow step of a later start, while another bridge serves the bus.
  void prepare(const BusSpec& bus);
  // Does those without DDS. start() must follow.
  void prepare_engine(const BusSpec& bus) { prepared_.emplace(bus.name, make(bus)); }
  // Starts the bus. Logs the rival and returns false if another bridge serves it. `followed`: the
  // state of a master that has left, or null. `margin`: added to its sample numbers if its last
  // samples may be missing. Throws DdsError; nothing of the bus is left then.
  bool start(const BusSpec& bus, const FollowedBus* followed = nullptr, std::uint64_t margin = 0);
  // Starts those of the configured buses, in their order.
  void start(const std::vector<std::string>& names);
  // Samples count above those of earlier terms, also of buses that start later.
  void count_above(StandbyTerm term);
  // Carries out a decision of the guard. `uncontested`: see BusGuard::Handlers.
  void follow_guard(const std::set<std::string>& uncontested);
  // Loads the alarm actions of users from the time when another bridge served the buses; both need
  // the same store. Waits for the database once, a few seconds at most.
  void load_alarms(const std::vector<std::string>& buses);

  // Stops all buses and publishes their last samples. Ends the process if a driver hangs.
  void stop_runners() { stop_runners(running()); }
  // Stops those that run and removes them from the domain. See DdsLink::remove_bus().
  void stop(std::vector<std::string> names, Duration dispose_limit = Duration::max(),
            DdsLink::Leave leave = DdsLink::Leave::kDispose);

 private:
  struct Bus {
    std::unique_ptr<BusOutput> sink;  // outlives the runner and its posted tasks
    std::unique_ptr<IoThread> io;     // stopped after the runner
    std::shared_ptr<BusRunner> runner;
    std::unique_ptr<GatewayServer> gateway;  // ends before the runner; null without `gateway`
  };
  [[nodiscard]] Bus make(const BusSpec& bus);
  void start_gateway(const BusSpec& spec, Bus& bus);
  void stop_runners(const std::vector<std::string>& names);
  [[noreturn]] void abandon(const std::string& bus);

  const Uses uses_;
  DdsLink& link_;
  const std::uint32_t domain_;
  const std::optional<StoreSpec> store_;
  bool trace_;
  std::uint64_t above_ = 0;
  std::vector<BusSpec> wanted_;
  std::set<std::string> contested_;  // buses that are already in the log
  CaptureService captures_;
  std::map<std::string, Bus, std::less<>> prepared_, running_;
};

}  // namespace fieldcast
