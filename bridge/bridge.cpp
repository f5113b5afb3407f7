#include "bridge/bridge.hpp"

#include <fmt/format.h>

#include <cstdlib>

#include "bridge/base/check.hpp"
#include "bridge/base/clock.hpp"
#include "bridge/base/exit_code.hpp"
#include "bridge/bridge_state.hpp"
#include "bridge/dds/transport/network_check.hpp"

namespace fieldcast {
namespace {

constexpr std::chrono::milliseconds kLinger{200};
constexpr std::chrono::milliseconds kPublishLimit{300};  // for samples that wait for DDS
// Time to dispose instances when the whole bridge leaves. 10 000 channels on a busy machine can
// need longer; the remaining instances end with the participant.
constexpr std::chrono::milliseconds kDisposeLimit{800};
constexpr std::chrono::milliseconds kLastWords{300};  // for the log to be written

}  // namespace

Bridge::Bridge() : state_(std::make_unique<State>()) {}

Bridge::~Bridge() { stop(); }

tl::expected<void, std::string> Bridge::start(const BridgeSpec& spec,
                                              const std::function<bool()>& give_up) {
  const std::lock_guard lock(state_->changing);
  state_->standby.leaving = false;
  return state_->start(spec, program::Server::Modules::kLetGo, give_up);
}

tl::expected<Bridge::Reloaded, std::string> Bridge::reload(const BridgeSpec& wanted) {
  const std::lock_guard lock(state_->changing);
  return state_->reload(wanted);
}

void Bridge::set_trace(bool on) {
  const std::lock_guard lock(state_->changing);
  state_->trace = on;
  for (auto& [name, bus] : state_->buses) bus.runner->set_trace(on);
}

std::vector<BusTurn> Bridge::turns() const {
  const std::lock_guard lock(state_->changing);
  std::vector<BusTurn> turns;
  for (const auto& [name, bus] : state_->buses) turns.push_back({name, bus.runner->last_turn()});
  return turns;
}

void Bridge::stop() {
  const bool handed_over = state_->hand_over_before_stop();
  {
    const std::lock_guard lock(state_->changing);
    state_->stop_all(program::Server::Modules::kLetGo,
                     handed_over ? DdsLink::Leave::kHandOver : DdsLink::Leave::kDispose);
  }
  state_->standby.end();
}

std::string Bridge::busy_with() const { return state_->step.load(); }

void Bridge::save(Duration limit) {
  const std::lock_guard lock(state_->store_mutex);
  if (state_->store) (void)state_->store->flush(limit);
}

tl::expected<void, std::string> Bridge::State::start(const BridgeSpec& wanted,
                                                     program::Server::Modules kept,
                                                     const std::function<bool()>& give_up) {
  FIELDCAST_CHECK(!link);
  spec = wanted;
  (void)alarms.configure(spec.buses, read_clocks().utc);  // DDS restarts without known alarms
  try {
    join();
    captures = std::make_unique<CaptureService>(spec.name);
    serve_metrics(spec);
    want_buses(spec);
    if (spec.standby) {
      for (const BusSpec& bus : spec.buses) {
        if (give_up()) return {};
        prepare_bus(bus);
      }
    }
    guard->settle(give_up);
    if (const auto absent = servers_remark(spec.dds.discovery_servers, link->missing_servers()))
      log_warning("dds", *absent);
    for (const BusSpec& bus : spec.buses) {
      if (give_up()) return {};
      if (!spec.standby) start_buses({bus.name}, spec);
    }
    interests.all_added();
    if (const auto listening = program.start(spec.program); !listening) {
      stop_all(kept);
      return tl::make_unexpected(listening.error());
    }
    guard->watch();
    if (spec.standby) take_part();
  } catch (const DdsError& error) {
    stop_all(kept);
    return tl::make_unexpected(std::string(error.what()));
  }
  return {};
}

// The complete order of a shutdown.
void Bridge::State::stop_all(program::Server::Modules kept, DdsLink::Leave leave) {
  if (!link) return;
  sinks.drop_from(steady_now() + kPublishLimit);
  metrics.reset();
  step = "the engineers are notified";
  guard->end();
  program.stop(kept);  // 0. engineers are notified, their devices released
  logins.reset();
  std::vector<std::string> names;
  for (const auto& [name, bus] : buses) names.push_back(name);
  // 1. to 4. in stop_runners() and stop_buses(), for all buses together
  stop_buses(names, kDisposeLimit, leave);
  captures.reset();
  leave_group();
  if (identities) identities->close();  // responds to waiting requests: their bus no longer exists
  step = "the bridge leaves the domain";
  // 5. The last results reach their readers, then the bridge leaves the domain. No handler is
  //   called afterwards.
  link->close(kLinger, leave);
  alarms.publish_with({});
  sinks.drain();
  channel.reset();
  standby.prepared.clear();
  link.reset();  // 6.
  group.reset();
  guard.reset();
  identities.reset();
  audit.open(nullptr);
  alarms.close(store.get());
  step = "the store is written";
  std::unique_ptr<Store> last;
  {
    const std::lock_guard lock(store_mutex);
    last.swap(store);
  }
  last.reset();  // 7. pending data is written
  sinks.drop_from(kNever);
  interests.forget();  // 8. stations declare their interests again to the next bridge
}

// A bus whose thread hangs in a driver (for example an ioctl of a failed USB adapter) cannot be
// destroyed. The process ends after the other buses have published; its supervisor restarts it.
void Bridge::State::abandon(const std::string& bus) {
  log_error(bus, "the bus hangs in its driver and cannot be stopped: the process ends");
  link->close(kLinger);
  if (store) (void)store->flush(kLinger);
  flush_log(kLastWords);
  std::_Exit(static_cast<int>(ExitCode::kHung));
}

std::string buses_text(const BridgeSpec& spec) {
  return fmt::format("{} {}, DDS domain {}", spec.buses.size(),
                     spec.buses.size() == 1 ? "bus" : "buses", spec.dds.domain);
}

}  // namespace fieldcast
