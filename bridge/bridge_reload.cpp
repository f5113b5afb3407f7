// Changes the configuration of a running bridge, and restores the previous one after a failure.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bridge/base/clock.hpp"
#include "bridge/bridge_state.hpp"
#include "bridge/standby/member_identity.hpp"
#include "core/base/message_text.hpp"

namespace fieldcast {
namespace {

std::optional<ChannelIndex> index_of(const BridgeSpec& bridge, const std::string& bus_name,
                                     const std::string& device_name,
                                     const std::string& channel_name) {
  for (const BusSpec& bus : bridge.buses) {
    if (bus.name != bus_name) continue;
    ChannelIndex index = 0;
    for (const DeviceSpec& device : bus.devices) {
      for (const ChannelSpec& channel : device.channels) {
        if (device.name == device_name && channel.name == channel_name) return index;
        ++index;
      }
    }
  }
  return std::nullopt;
}

}  // namespace

// Ends alarms whose limit was removed, while their bus can still publish that.
void Bridge::State::configure_alarms(const BridgeSpec& from, const BridgeSpec& to) {
  const UtcMapping now = read_clocks();
  for (const AlarmRecord& ended : alarms.configure(to.buses, now.utc)) {
    log_info(fmt::format("{}/{}/{}", ended.bus, ended.device, ended.channel),
             fmt::format("alarm {} ends: its limit is taken away", ended.limit));
    const auto index = index_of(from, ended.bus, ended.device, ended.channel);
    const auto limit = limit_kind_from(ended.limit);
    if (!index || !limit) continue;
    const AlarmChange change{*index, *limit, AlarmState::kClear, ended.value, now.instant};
    sinks.post([this, bus = ended.bus, change, now] { link->report(bus, change, now); });
  }
}

// Stops and starts everything. After an error, restarts with the previous configuration.
tl::expected<void, std::string> Bridge::State::start_anew(const BridgeSpec& wanted,
                                                          const ReloadPlan& plan) {
  const BridgeSpec before = spec;
  log_info(
      before.name,
      fmt::format("reloading: {}: all buses are restarted: {}, the participant "
                  "in DDS domain {}{}{}",
                  fmt::join(plan.whole_bridge, ", "), counted(before.buses.size(), "bus", "buses"),
                  before.dds.domain, before.store ? ", the store" : "",
                  before.program == ProgramSpec{} ? "" : ", the programming server"));
  stop_all(program::Server::Modules::kKeep);
  auto started = start(wanted, program::Server::Modules::kKeep);
  if (started) {
    log_info(wanted.name, "reloaded: all buses were restarted: " + buses_text(wanted));
    return {};
  }
  if (auto back = start(before, program::Server::Modules::kKeep); !back)
    return tl::make_unexpected(fmt::format("{}; and then {}", started.error(), back.error()));
  return tl::make_unexpected(started.error());
}

// After an error, restarts the server with the previous configuration.
tl::expected<void, std::string> Bridge::State::restart_program(const BridgeSpec& wanted) {
  log_info(spec.name, "reloading: the programming server restarts; modules stay connected");
  program.stop(program::Server::Modules::kKeep);
  auto listening = program.start(wanted.program);
  if (!listening) (void)program.start(spec.program);
  return listening;
}

// Restarts only the programming server and the changed buses; after an error, the old ones.
tl::expected<void, std::string> Bridge::State::exchange_buses(const BridgeSpec& wanted,
                                                              const ReloadPlan& plan) {
  const BridgeSpec before = spec;
  if (plan.program) {
    if (auto listening = restart_program(wanted); !listening) return listening;
  }
  configure_alarms(before, wanted);
  stop_buses(running(plan.stop));
  want_buses(wanted);
  try {
    start_buses(plan.start, wanted);
  } catch (const DdsError& error) {
    stop_buses(running(plan.start));
    want_buses(before);
    if (plan.program) {
      program.stop(program::Server::Modules::kKeep);
      (void)program.start(before.program);
    }
    configure_alarms(wanted, before);
    start_buses(plan.stop, before);
    return tl::make_unexpected(std::string(error.what()));
  }
  if (plan.metrics) serve_metrics(wanted);
  for (const BusSpec& bus : wanted.buses) captures->configure(bus.name, bus.capture);
  spec = wanted;
  if (group) group->set_configuration(common_configuration(spec));
  const auto names = [](const std::vector<std::string>& listed) {
    return listed.empty() ? std::string{} : fmt::format(" ({})", fmt::join(listed, ", "));
  };
  log_info(wanted.name, fmt::format("reloaded: {} stopped{}, {} started{}, {} untouched",
                                    counted(plan.stop.size(), "bus", "buses"), names(plan.stop),
                                    plan.start.size(), names(plan.start), plan.untouched.size()));
  return {};
}

// Another bridge of the group takes over, so that no refresh is missed. This bridge then restarts
// as a standby with the files that are in its directory.
bool Bridge::State::hand_over_for_renewal() {
  if (const auto refused = group->hand_over({})) {
    log_warning(spec.name, "renewed with a gap, as no other bridge takes over: " + *refused);
    return false;
  }
  log_info(spec.name, "reloading: a renewed certificate: another bridge of the group takes over");
  return true;
}

tl::expected<Bridge::Reloaded, std::string> Bridge::State::reload(const BridgeSpec& wanted) {
  const auto done = [](const tl::expected<void, std::string>& result) {
    return result.map([] { return Reloaded{}; });
  };
  if (!link) {  // an earlier reload failed, and the previous configuration could not be restored
    return done(start(wanted, program::Server::Modules::kKeep));
  }
  ReloadPlan plan = plan_reload(spec, wanted);
  const bool renewed = plan.whole_bridge.empty() && link->has_new_identity();
  const bool only_renewed = renewed && plan.nothing();
  if (renewed) plan = ReloadPlan{.whole_bridge = {"a renewed certificate"}};
  Reloaded waiting;
  for (const auto& leased : disturbed_by(plan, wanted, program.leased()))
    waiting.waits_for.push_back(fmt::format("{}/{} by {}", leased.bus, leased.device, leased.who));
  if (!waiting.waits_for.empty()) return waiting;
  if (group && standby.serving && only_renewed && hand_over_for_renewal()) return Reloaded{};
  // A restart of a waiting bridge disturbs nothing.
  if (group && !standby.serving) return done(start_anew(wanted, plan));
  return done(plan.whole_bridge.empty() ? exchange_buses(wanted, plan) : start_anew(wanted, plan));
}

}  // namespace fieldcast
