// The set of buses: which buses this bridge serves, how a bus starts and how buses stop.
#include <fmt/format.h>

#include <algorithm>
#include <future>

#include "bridge/base/check.hpp"
#include "bridge/base/clock.hpp"
#include "bridge/bridge_state.hpp"
#include "bridge/store/alarm_life_table.hpp"

namespace fieldcast {
namespace {

// Limit for all buses together, so that a stop ends within two seconds. It is divided into turns: a
// machine that pauses uses up only one turn, so no bus is wrongly treated as hanging.
constexpr std::chrono::milliseconds kStopTurn{100};
constexpr int kStopTurns = 12;
// Time for the readers of all stopping buses to receive the last samples.
constexpr std::chrono::milliseconds kBusLinger{300};
constexpr Duration kProve = std::chrono::seconds{3};  // BusOutput::prove_until()

}  // namespace

void Bridge::State::want_buses(const BridgeSpec& wanted) {
  std::vector<std::string> names;
  for (const BusSpec& bus : wanted.buses) names.push_back(bus.name);
  guard->want(link->id(), names);
}

std::vector<std::string> Bridge::State::running(std::vector<std::string> names) const {
  std::erase_if(names, [this](const std::string& name) { return !buses.contains(name); });
  return names;
}

// Starts those of `names` that this bridge serves. Throws DdsError.
void Bridge::State::start_buses(const std::vector<std::string>& names, const BridgeSpec& from) {
  for (const BusSpec& bus : from.buses) {
    if (std::find(names.begin(), names.end(), bus.name) == names.end()) continue;
    if (guard->serves(bus.name)) {
      start_bus(bus);
    } else {
      log_error(bus.name, fmt::format("not served here: {} serves a bus of this name in DDS domain "
                                      "{}, where names of buses are unique. This bridge takes it "
                                      "over when that one has left; else rename one of the two",
                                      guard->rival(bus.name), spec.dds.domain));
      link->listen_for_commands();
    }
  }
}

// Carries out the guard's decision, on the guard's thread.
bool Bridge::State::follow_guard(const std::set<std::string>& uncontested) {
  const std::unique_lock lock(changing, std::try_to_lock);
  if (!lock) return false;  // the main thread stops or reloads
  const std::set<std::string> now_contested = guard->contested();
  for (const std::string& bus : now_contested) {
    if (contested.contains(bus)) continue;
    log_counted(LogLevel::kError, bus, "contested buses",
                fmt::format("contested: {} says that it serves a bus of this name, too, in DDS "
                            "domain {}, where names of buses are unique. This bridge serves it "
                            "on; stop or rename one of the two",
                            guard->rival(bus), spec.dds.domain));
  }
  for (const std::string& bus : contested) {
    if (!now_contested.contains(bus) && buses.contains(bus))
      log_counted(LogLevel::kInfo, bus, "contested buses",
                  "contested no longer: only this bridge serves it");
  }
  contested = now_contested;
  for (const BusSpec& bus : spec.buses) {
    if (buses.contains(bus.name) || !guard->serves(bus.name)) continue;
    log_warning(bus.name,
                "taken over: the bridge that served a bus of this name has left the domain");
    take_over_alarms(bus.name);
    try {
      start_bus(bus);
    } catch (const DdsError& error) { log_error(bus.name, error.what()); }
  }
  for (const std::string& bus : uncontested) link->publish_again(bus);
  return true;
}

// Loads the alarm actions of users from the time when another bridge served the bus; both need the
// same store. Waits for the database, a few seconds at most.
void Bridge::State::take_over_alarms(const std::string& bus) {
  if (!spec.store) return;
  try {
    const auto connection =
        fieldcast::open_store(StoreAddress(spec.store->address), IfMissing::kFail);
    alarms.loaded(bus, AlarmLifeTable(*connection).kept(read_clocks().utc));
  } catch (const StoreError& error) {
    log_warning(bus, fmt::format("its alarms are as this bridge knew them: {}", error.what()));
  }
}

RunningBus Bridge::State::make_bus(const BusSpec& bus) {
  RunningBus made;
  const BusOutput::Shared shared{sinks,
                                 *link,
                                 store.get(),
                                 audit,
                                 alarms,
                                 figures,
                                 lease,
                                 [this](const std::string& name, const CommandResult& result) {
                                   return keeps_result(name, result);
                                 },
                                 spec.standby.has_value()};
  made.sink = std::make_unique<BusOutput>(shared, bus);
  made.io = std::make_unique<IoThread>(bus.name);
  made.runner = std::make_shared<BusRunner>(made.io->context(), plans.context(), bus, *made.sink,
                                            &modules, &lease);
  return made;
}

// Throws DdsError; nothing of the bus is left then.
void Bridge::State::start_bus(const BusSpec& bus, const FollowedBus* followed,
                              std::uint64_t margin) {
  FIELDCAST_CHECK(!buses.contains(bus.name));
  auto ready = standby.prepared.extract(bus.name);
  RunningBus made = ready ? std::move(ready.mapped()) : make_bus(bus);
  // Before the bus is announced, because commands can arrive immediately.
  commands.add(bus.name, made.runner);
  try {
    followed == nullptr ? link->add_bus(bus) : link->take_over_bus(bus, *followed);
  } catch (const DdsError&) {
    commands.remove(bus.name);
    made.runner->stop().wait();  // responds to commands that arrived meanwhile
    sinks.drain();
    link->remove_bus(bus.name, Duration::zero());
    figures.remove(bus.name);
    throw;
  }
  alarms.publish_again(bus.name);
  made.runner->set_trace(trace);
  made.runner->set_capture(captures->add_bus(bus));
  BusInheritance inherited = followed == nullptr ? BusInheritance{} : followed->state;
  for (Sample& sample : inherited.samples) {
    if (sample.sequence != 0) sample.sequence += margin;
  }
  if (spec.standby) inherited.above = sequences_of(standby.term);
  const Instant now = steady_now();
  if (followed != nullptr && margin != 0) made.sink->prove_until(now + kProve, now);
  made.runner->start(std::move(inherited));
  interests.add(bus, made.runner);
  program.add_bus(bus, made.runner);
  buses.emplace(bus.name, std::move(made));
}

void Bridge::State::stop_runners(const std::vector<std::string>& names) {
  step = "the buses stop";
  std::vector<std::future<void>> stopped;
  for (const std::string& name : names) {
    program.remove_bus(name);  // no more requests for its devices; a pairing ends with the bus
    interests.remove(name);
    commands.remove(name);  // 1. no more commands; later ones get kShutdown
    // 2. Pending commands get a response, the port is closed.
    stopped.push_back(buses.at(name).runner->stop());
  }
  int turns = kStopTurns;
  for (std::size_t i = 0; i < names.size(); ++i) {
    while (stopped[i].wait_for(kStopTurn) != std::future_status::ready) {
      if (--turns < 0) abandon(names[i]);
    }
  }
  for (const std::string& name : names) captures->remove_bus(name);
  step = "the last samples leave";
  sinks.drain();  // 3. posted samples are published
}

void Bridge::State::stop_buses(const std::vector<std::string>& names, Duration dispose_limit,
                               DdsLink::Leave leave) {
  stop_runners(names);
  step = "the buses leave the domain";
  const Instant begun = steady_now(), gone = begun + kBusLinger;
  for (const std::string& name : names) {
    // 4. Stations see that the bus ended.
    const Instant now = steady_now();
    if (leave == DdsLink::Leave::kDispose) {
      link->remove_bus(
          name, std::max(gone - now, Duration::zero()),
          dispose_limit == Duration::max() ? Duration::max() : dispose_limit - (now - begun));
    }
    buses.erase(name);
    figures.remove(name);
  }
}

}  // namespace fieldcast
