#include "bridge/buses/bus_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <future>

#include "bridge/base/check.hpp"
#include "bridge/base/clock.hpp"
#include "bridge/base/exit_code.hpp"
#include "bridge/log/log.hpp"
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
// Limits of each step before the process ends with a bus that hangs.
constexpr std::chrono::milliseconds kAbandonLinger{200};
constexpr std::chrono::milliseconds kAbandonLog{300};

}  // namespace

BusSet::BusSet(const Uses& uses, const BridgeSpec& spec, bool trace)
    : uses_(uses),
      link_(uses.output.link),
      domain_(spec.dds.domain),
      store_(spec.store),
      trace_(trace),
      captures_(spec.name) {}

void BusSet::want(const std::vector<BusSpec>& buses) {
  std::set<std::string> left;
  for (const BusSpec& bus : wanted_) left.insert(bus.name);
  wanted_ = buses;
  std::vector<std::string> names;
  for (const BusSpec& bus : buses) {
    names.push_back(bus.name);
    left.erase(bus.name);
  }
  uses_.guard.want(link_.id(), names);
  // Not earlier: stations send commands as long as the bus is announced.
  for (const std::string& bus : left) link_.ignore_requests(bus);
}

std::vector<std::string> BusSet::running() const {
  std::vector<std::string> names;
  for (const auto& [name, bus] : running_) names.push_back(name);
  return names;
}

std::vector<BusTurn> BusSet::turns() const {
  std::vector<BusTurn> turns;
  for (const auto& [name, bus] : running_) turns.push_back({name, bus.runner->last_turn()});
  return turns;
}

void BusSet::set_trace(bool on) {
  trace_ = on;
  for (auto& [name, bus] : running_) bus.runner->set_trace(on);
}

void BusSet::configure_captures() {
  for (const BusSpec& bus : wanted_) captures_.configure(bus.name, bus.capture);
}

bool BusSet::probe(const std::string& bus, DeviceProbe probe, BusRunner::Probed done) {
  const auto found = running_.find(bus);
  return found != running_.end() && found->second.runner->probe(std::move(probe), std::move(done));
}

void BusSet::count_above(StandbyTerm term) {
  above_ = sequences_of(term);
  for (const auto& [name, bus] : running_) {
    bus.runner->count_above(above_);
    uses_.output.alarms.publish_again(name);
  }
}

void BusSet::follow_guard(const std::set<std::string>& uncontested) {
  const std::set<std::string> contested = uses_.guard.contested();
  for (const std::string& bus : contested) {
    if (contested_.contains(bus)) continue;
    log_counted(LogLevel::kError, bus, "contested buses",
                fmt::format("contested: {} says that it serves a bus of this name, too, in DDS "
                            "domain {}, where names of buses are unique. This bridge serves it "
                            "on; stop or rename one of the two",
                            uses_.guard.rival(bus), domain_));
  }
  for (const std::string& bus : contested_) {
    if (!contested.contains(bus) && running_.contains(bus))
      log_counted(LogLevel::kInfo, bus, "contested buses",
                  "contested no longer: only this bridge serves it");
  }
  contested_ = contested;
  std::vector<std::string> taken;
  for (const BusSpec& bus : wanted_) {
    if (running_.contains(bus.name) || !uses_.guard.serves(bus.name)) continue;
    log_warning(bus.name,
                "taken over: the bridge that served a bus of this name has left the domain");
    taken.push_back(bus.name);
  }
  load_alarms(taken);
  for (const BusSpec& bus : wanted_) {
    if (std::ranges::find(taken, bus.name) == taken.end()) continue;
    try {
      start(bus);
    } catch (const DdsError& error) { log_error(bus.name, error.what()); }
  }
  for (const std::string& bus : uncontested) link_.publish_again(bus);
}

void BusSet::load_alarms(const std::vector<std::string>& buses) {
  if (!store_ || buses.empty()) return;
  try {
    const auto connection = open_store(StoreAddress(store_->address), IfMissing::kFail);
    const KeptAlarms kept = AlarmLifeTable(*connection).kept(read_clocks().utc);
    for (const std::string& bus : buses) uses_.output.alarms.loaded(bus, kept);
  } catch (const StoreError& error) {
    for (const std::string& bus : buses)
      log_warning(bus, fmt::format("its alarms are as this bridge knew them: {}", error.what()));
  }
}

BusSet::Bus BusSet::make(const BusSpec& bus) {
  Bus made;
  made.sink = std::make_unique<BusOutput>(uses_.output, bus);
  made.io = std::make_unique<IoThread>(bus.name);
  made.runner = std::make_shared<BusRunner>(*made.io, uses_.plans.context(), bus, *made.sink,
                                            &uses_.modules, &uses_.output.lease);
  return made;
}

void BusSet::prepare(const BusSpec& bus) {
  prepare_engine(bus);
  link_.prepare_bus(bus);
}

bool BusSet::start(const BusSpec& bus, const FollowedBus* followed, std::uint64_t margin) {
  if (!uses_.guard.serves(bus.name)) {
    log_error(bus.name, fmt::format("not served here: {} serves a bus of this name in DDS domain "
                                    "{}, where names of buses are unique. This bridge takes it "
                                    "over when that one has left; else rename one of the two",
                                    uses_.guard.rival(bus.name), domain_));
    prepared_.erase(bus.name);  // its configuration may change until a takeover
    link_.ignore_requests(bus.name);
    link_.listen_for_commands();
    return false;
  }
  FIELDCAST_CHECK(!running_.contains(bus.name));
  auto ready = prepared_.extract(bus.name);
  Bus made = ready ? std::move(ready.mapped()) : make(bus);
  // Before the bus is announced, because commands can arrive immediately.
  uses_.commands.add(bus.name, made.runner);
  try {
    followed == nullptr ? link_.add_bus(bus) : link_.take_over_bus(bus, *followed);
    if (uses_.output.store != nullptr)
      uses_.output.store->put(BusEpoch{bus.name, link_.epoch_of(bus.name)});
  } catch (const DdsError&) {
    uses_.commands.remove(bus.name);
    made.runner->stop().wait();  // responds to commands that arrived meanwhile
    uses_.output.thread.drain();
    link_.remove_bus(bus.name, Duration::zero());
    uses_.output.figures.remove(bus.name);
    throw;
  }
  uses_.output.alarms.publish_again(bus.name);
  made.runner->set_trace(trace_);
  made.runner->set_capture(captures_.add_bus(bus));
  BusInheritance inherited = followed == nullptr ? BusInheritance{} : followed->state;
  for (Sample& sample : inherited.samples) {
    if (sample.sequence != 0) sample.sequence += margin;
  }
  inherited.above = above_;
  const Instant now = steady_now();
  if (followed != nullptr && margin != 0) made.sink->prove_until(now + kProve, now);
  made.runner->start(std::move(inherited));
  uses_.interests.add(bus, made.runner);
  uses_.output.inputs.add(
      bus, wanted_,
      {[runner = made.runner](InputRelay::Fetch fetch) { runner->post_inputs(std::move(fetch)); },
       [runner = made.runner] { runner->count_above(0); }});
  uses_.program.add_bus(bus, made.runner);
  start_gateway(bus, made);
  running_.emplace(bus.name, std::move(made));
  return true;
}

// Reads go to the bus only: they are neither noted nor audited, and each may run twice.
void BusSet::start_gateway(const BusSpec& spec, Bus& bus) {
  if (!spec.gateway) return;
  CommandService& commands = uses_.output.commands;
  const auto submit = [&commands, name = spec.name, runner = bus.runner](
                          const Command& command) -> std::optional<CommandResult> {
    if (!command.is_gateway_read()) {
      commands.receive(name, command);
    } else if (!runner->post(command)) {
      return rejection(command, Cause::kQueueFull, "too many commands wait for this bus",
                       steady_now());
    }
    return std::nullopt;
  };
  const auto report = [&figures = uses_.output.figures,
                       name = spec.name](const gateway::Counters& counters) {
    figures.note(GatewayFigures{name, counters});
  };
  bus.gateway = std::make_unique<GatewayServer>(spec, GatewayServer::Uses{submit, report});
  commands.set_gateway(spec.name, [&server = *bus.gateway](const CommandResult& result) {
    server.complete(result);
  });
  bus.gateway->start();
}

void BusSet::start(const std::vector<std::string>& names) {
  for (const BusSpec& bus : wanted_) {
    if (std::ranges::find(names, bus.name) != names.end()) start(bus);
  }
}

void BusSet::stop_runners(const std::vector<std::string>& names) {
  uses_.step = "the buses stop";
  std::vector<std::future<void>> stopped;
  for (const std::string& name : names) {
    uses_.output.commands.set_gateway(name, {});
    running_.at(name).gateway.reset();  // its clients are disconnected
    uses_.program.remove_bus(name);     // no more requests for its devices; a pairing ends
    uses_.interests.remove(name);
    uses_.output.inputs.remove(name);
    uses_.commands.remove(name);  // 1. no more commands; later ones get kShutdown
    // 2. Pending commands get a response, the port is closed.
    stopped.push_back(running_.at(name).runner->stop());
  }
  int turns = kStopTurns;
  for (std::size_t i = 0; i < names.size(); ++i) {
    while (stopped[i].wait_for(kStopTurn) != std::future_status::ready) {
      if (--turns < 0) abandon(names[i]);
    }
  }
  for (const std::string& name : names) captures_.remove_bus(name);
  uses_.step = "the last samples leave";
  uses_.output.thread.drain();  // 3. posted samples are published
}

void BusSet::stop(std::vector<std::string> names, Duration dispose_limit, DdsLink::Leave leave) {
  std::erase_if(names, [this](const std::string& name) { return !running_.contains(name); });
  stop_runners(names);
  uses_.step = "the buses leave the domain";
  const Instant begun = steady_now(), gone = begun + kBusLinger;
  for (const std::string& name : names) {
    // 4. Stations see that the bus ended.
    const Instant now = steady_now();
    if (leave == DdsLink::Leave::kDispose) {
      link_.remove_bus(
          name, std::max(gone - now, Duration::zero()),
          dispose_limit == Duration::max() ? Duration::max() : dispose_limit - (now - begun));
    }
    running_.erase(name);
    uses_.output.figures.remove(name);
  }
}

// A bus whose thread hangs in a driver (for example an ioctl of a failed USB adapter) cannot be
// destroyed. The process ends after the other buses have published; its supervisor restarts it.
void BusSet::abandon(const std::string& bus) {
  log_error(bus, "the bus hangs in its driver and cannot be stopped: the process ends");
  link_.close(kAbandonLinger);
  if (uses_.output.store != nullptr) (void)uses_.output.store->flush(kAbandonLinger);
  flush_log(kAbandonLog);
  std::_Exit(static_cast<int>(ExitCode::kHung));
}

}  // namespace fieldcast
