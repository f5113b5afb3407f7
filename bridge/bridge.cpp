#include "bridge/bridge.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bridge/base/check.hpp"
#include "bridge/base/clock.hpp"
#include "bridge/dds/library/library.hpp"
#include "bridge/dds/transport/network_check.hpp"
#include "bridge/log/log.hpp"
#include "core/base/message_text.hpp"

namespace fieldcast {
namespace {

constexpr std::chrono::milliseconds kLinger{200};
constexpr std::chrono::milliseconds kPublishLimit{300};  // for samples that wait for DDS
// Time to dispose instances when the whole bridge leaves. 10 000 channels on a busy machine can
// need longer; the remaining instances end with the participant.
constexpr std::chrono::milliseconds kDisposeLimit{800};

bool never() { return false; }

}  // namespace

tl::expected<void, std::string> Bridge::start(const BridgeSpec& spec,
                                              const std::function<bool()>& give_up) {
  const std::lock_guard lock(changing_);
  leaving_ = false;
  return start_all(spec, Modules::kLetGo, give_up);
}

void Bridge::set_trace(bool on) {
  const std::lock_guard lock(changing_);
  trace_ = on;
  if (buses_) buses_->set_trace(on);
}

void Bridge::respond(const ConfigurationMessage& reply) {
  const std::lock_guard lock(changing_);
  if (link_) link_->respond(reply);
}

bool Bridge::probe(const std::string& bus, DeviceProbe probe, BusRunner::Probed done) {
  const std::lock_guard lock(changing_);
  return buses_ && buses_->probe(bus, std::move(probe), std::move(done));
}

std::optional<std::map<std::string, Quality>> Bridge::qualities() const {
  const std::lock_guard lock(changing_);
  if (!link_) return std::nullopt;
  std::map<std::string, Quality> all;
  for (const BusSpec& bus : spec_.buses) {
    const std::vector<Quality> qualities = link_->qualities(bus);
    // Another bridge of the group serves the bus.
    if (qualities.empty() && membership_) continue;
    std::size_t next = 0;
    for (const DeviceSpec& device : bus.devices) {
      for (const ChannelSpec& channel : device.channels) {
        const Quality quality = qualities.empty() ? Quality::kNotYetRead : qualities[next++];
        const bool is_read_soon = read_by_itself(channel) && channel.refresh <= kSoon;
        if (quality != Quality::kNotYetRead || is_read_soon)
          all.emplace(bus.name + '/' + device.name + '/' + channel.name, quality);
      }
    }
  }
  return all;
}

std::vector<BusTurn> Bridge::turns() const {
  const std::lock_guard lock(changing_);
  return buses_ ? buses_->turns() : std::vector<BusTurn>{};
}

void Bridge::stop() {
  leaving_ = true;
  roles_.notify();
  bool handed_over = false, needs_successor = false;
  {
    const std::lock_guard lock(changing_);
    handed_over = membership_ != nullptr;
    needs_successor = membership_ && membership_->needs_successor();
  }
  // Without the lock, so that the thread of roles can release the buses.
  if (needs_successor) handed_over = membership_->hand_over_before_stop();
  {
    const std::lock_guard lock(changing_);
    stop_all(Modules::kLetGo, handed_over ? DdsLink::Leave::kHandOver : DdsLink::Leave::kDispose);
  }
  roles_.end();
}

void Bridge::save(Duration limit) {
  const std::lock_guard lock(store_mutex_);
  if (store_) (void)store_->store.flush(limit);
}

Bridge::Started Bridge::start_all(const BridgeSpec& wanted, Modules modules,
                                  const std::function<bool()>& give_up) {
  FIELDCAST_CHECK(!link_);
  removed_ = false;
  spec_ = wanted;
  (void)alarms_.configure(spec_.buses, read_clocks().utc);  // DDS restarts without known alarms
  try {
    join();
    serve_metrics(spec_);
    buses_->want(spec_.buses);
    // While the other bridges announce themselves.
    for (const BusSpec& bus : spec_.buses) {
      if (give_up()) return {};
      membership_ ? buses_->prepare(bus) : buses_->prepare_engine(bus);
    }
    guard_->settle(give_up);
    if (const auto absent = servers_remark(spec_.dds.discovery_servers, link_->missing_servers()))
      log_warning("dds", *absent);
    for (const BusSpec& bus : spec_.buses) {
      if (give_up()) return {};
      if (!membership_) buses_->start(bus);
    }
    interests_.all_added();
    if (auto listening = program_.start(spec_.program); !listening) {
      stop_all(modules);
      return listening;
    }
    guard_->watch();
    if (membership_) {
      membership_->take_part();
      roles_.start([this] { return follow_role(); });
      roles_.notify();
    }
  } catch (const DdsError& error) {
    stop_all(modules);
    return tl::make_unexpected(std::string(error.what()));
  }
  return {};
}

// The complete order of a shutdown.
void Bridge::stop_all(Modules modules, DdsLink::Leave leave) {
  if (!link_) return;
  sinks_.drop_from(steady_now() + kPublishLimit);
  metrics_.reset();
  step_ = "the engineers are notified";
  guard_->end();
  program_.stop(modules);  // 0. engineers are notified, their devices released
  // 1. to 4. in BusSet, for all buses together
  buses_->stop(buses_->running(), kDisposeLimit, leave);
  if (membership_) memory_ = membership_->leave();
  if (store_) store_->identities.close();  // responds to waiting requests: their bus has ended
  receives_history_ = nullptr;
  if (history_) history_->close();
  step_ = "the bridge leaves the domain";
  // Stations send commands as long as a bus is announced, and each gets kShutdown as long as the
  // bridge listens.
  if (leave == DdsLink::Leave::kDispose && guard_->withdraw())
    link_->wait_for_announcement(kLinger);
  // 5. The last results reach their readers; then the bridge leaves, and no handler is called.
  link_->close(kLinger, leave);
  alarms_.publish_with({});
  sinks_.drain();
  commands_.close();
  membership_.reset();
  buses_.reset();
  history_.reset();
  audit_.open(nullptr);
  published_audit_.reset();
  link_.reset();  // 6.
  guard_.reset();
  step_ = "the store is written";
  alarms_.close(store_ ? &store_->store : nullptr);
  std::unique_ptr<OpenStore> last;
  {
    const std::lock_guard lock(store_mutex_);
    last.swap(store_);
  }
  last.reset();  // 7. pending data is written
  sinks_.drop_from(kNever);
  interests_.forget();  // 8. stations declare their interests again to the next bridge
}

// Runs on the thread of roles. Returns true if it must be called again soon.
bool Bridge::follow_role() {
  const std::unique_lock lock(changing_, std::try_to_lock);
  if (!lock) return true;  // the main thread stops or reloads
  if (leaving_ && !(membership_ && membership_->is_serving())) return false;
  if (membership_) {
    const Membership::Next next = membership_->follow_role(leaving_);
    if (next != Membership::Next::kRestart) return next == Membership::Next::kSoon;
  } else if (link_) {
    return false;
  }
  restart_as_standby();  // also if the last restart failed
  return false;
}

// Restarts everything without disposing the instances that another bridge now serves.
void Bridge::restart_as_standby() {
  const BridgeSpec same = spec_;
  stop_all(Modules::kKeep, DdsLink::Leave::kHandOver);
  commands_.handed_over();
  const auto started = start_all(same, Modules::kKeep, [this] { return leaving_.load(); });
  if (!started) log_error(same.name, "cannot stand by: " + started.error());
}

tl::expected<Bridge::Reloaded, std::string> Bridge::reload(const BridgeSpec& wanted) {
  // If another bridge takes over, the thread of roles restarts this one first.
  const Duration longest = Election::kHandOver + 2 * HandOverPause::kLength;
  (void)roles_.wait_until(steady_now() + longest, [this] {
    const std::lock_guard lock(changing_);
    return !membership_ || !membership_->is_pausing();
  });
  const std::lock_guard lock(changing_);
  const auto done = [](const Started& result) { return result.map([] { return Reloaded{}; }); };
  // An earlier reload failed, and the previous configuration could not be restored.
  if (!link_) return done(start_all(wanted, Modules::kKeep, never));
  ReloadPlan plan = plan_reload(spec_, wanted);
  if (removed_ && plan.whole_bridge.empty())
    plan = ReloadPlan{.whole_bridge = {"the process was suspended"}};
  const bool renewed = plan.whole_bridge.empty() && link_->has_new_identity();
  const bool only_renewed = renewed && plan.nothing();
  if (renewed) plan = ReloadPlan{.whole_bridge = {"a renewed certificate"}};
  Reloaded waiting;
  for (const auto& leased : disturbed_by(plan, wanted, program_.leased()))
    waiting.waits_for.push_back(fmt::format("{}/{} by {}", leased.bus, leased.device, leased.who));
  if (!waiting.waits_for.empty()) return waiting;
  const bool serves_group = membership_ && membership_->is_serving();
  if (serves_group && only_renewed) {
    // Another bridge takes over, so that no refresh is missed. This bridge restarts as a standby.
    const auto refused = membership_->hand_over();
    if (!refused) {
      log_info(spec_.name,
               "reloading: a renewed certificate: another bridge of the group takes over");
      return Reloaded{};
    }
    log_warning(spec_.name, "renewed with a gap, as no other bridge takes over: " + *refused);
  }
  // A restart of a waiting bridge disturbs nothing.
  const bool waits = membership_ && !serves_group;
  return done(waits || !plan.whole_bridge.empty() ? start_anew(wanted, plan)
                                                  : exchange_buses(wanted, plan));
}

bool Bridge::is_running() const {
  const std::lock_guard lock(changing_);
  return link_ != nullptr;
}

// Ends alarms whose limit was removed, while their bus can still publish that.
void Bridge::configure_alarms(const BridgeSpec& from, const BridgeSpec& to) {
  const UtcMapping now = read_clocks();
  for (const AlarmRecord& ended : alarms_.configure(to.buses, now.utc)) {
    log_info(fmt::format("{}/{}/{}", ended.bus, ended.device, ended.channel),
             fmt::format("alarm {} ends: its limit is taken away", ended.limit));
    if (const auto change = end_of_alarm(from, ended, now.instant))
      sinks_.post(
          [this, bus = ended.bus, change = *change, now] { link_->report(bus, change, now); });
  }
}

// Stops and starts everything. After an error, restarts with the previous configuration.
Bridge::Started Bridge::start_anew(const BridgeSpec& wanted, const ReloadPlan& plan) {
  const BridgeSpec before = spec_;
  log_info(
      before.name,
      fmt::format("reloading: {}: all buses are restarted: {}, the participant "
                  "in DDS domain {}{}{}",
                  fmt::join(plan.whole_bridge, ", "), counted(before.buses.size(), "bus", "buses"),
                  before.dds.domain, before.store ? ", the store" : "",
                  before.program == ProgramSpec{} ? "" : ", the programming server"));
  // Another bridge of the group may serve the buses of a bridge that was removed.
  stop_all(Modules::kKeep,
           removed_ && membership_ ? DdsLink::Leave::kHandOver : DdsLink::Leave::kDispose);
  Started started = start_all(wanted, Modules::kKeep, never);
  if (started) {
    log_info(wanted.name, "reloaded: all buses were restarted: " + buses_text(wanted));
  } else if (const auto back = start_all(before, Modules::kKeep, never); !back) {
    return tl::make_unexpected(fmt::format("{}; and then {}", started.error(), back.error()));
  }
  return started;
}

// Restarts only the programming server and the changed buses; after an error, the old ones.
Bridge::Started Bridge::exchange_buses(const BridgeSpec& wanted, const ReloadPlan& plan) {
  const auto restart_program = [this](const ProgramSpec& program) {
    program_.stop(Modules::kKeep);
    return program_.start(program);
  };
  if (plan.program) {
    log_info(spec_.name, "reloading: the programming server restarts; modules stay connected");
    if (auto listening = restart_program(wanted.program); !listening) {
      (void)program_.start(spec_.program);
      return listening;
    }
  }
  configure_alarms(spec_, wanted);
  buses_->stop(plan.stop);
  buses_->want(wanted.buses);
  try {
    buses_->start(plan.start);
  } catch (const DdsError& error) {
    buses_->stop(plan.start);
    buses_->want(spec_.buses);
    if (plan.program) (void)restart_program(spec_.program);
    configure_alarms(wanted, spec_);
    buses_->start(plan.stop);
    return tl::make_unexpected(std::string(error.what()));
  }
  if (plan.metrics) serve_metrics(wanted);
  buses_->configure_captures();
  spec_ = wanted;
  if (membership_) membership_->reconfigure(spec_);
  log_info(wanted.name, to_text(plan));
  return {};
}

std::string buses_text(const BridgeSpec& spec) {
  return fmt::format("{}, DDS domain {}", counted(spec.buses.size(), "bus", "buses"),
                     spec.dds.domain);
}

}  // namespace fieldcast
