#include "bridge/bridge.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <future>
#include <map>
#include <mutex>
#include <set>
#include <vector>

#include "bridge/bus/bus_runner.hpp"
#include "bridge/bus/clock.hpp"
#include "bridge/bus/io_thread.hpp"
#include "bridge/check.hpp"
#include "bridge/command/command_audit.hpp"
#include "bridge/command/command_router.hpp"
#include "bridge/dds/dds_link.hpp"
#include "bridge/exit_code.hpp"
#include "bridge/interest/interest_registry.hpp"
#include "bridge/log/log.hpp"
#include "bridge/port/dial_in_registry.hpp"
#include "bridge/program/server.hpp"
#include "bridge/publish/bus_output.hpp"
#include "bridge/publish/publisher_thread.hpp"
#include "bridge/reload_plan.hpp"
#include "bridge/standby/bus_guard.hpp"
#include "bridge/store/authenticator.hpp"
#include "bridge/store/command_identities.hpp"
#include "bridge/store/store.hpp"

namespace fieldcast {
namespace {

// For all buses together, so that a stop ends within two seconds.
constexpr std::chrono::milliseconds kStopLimit{1200};
constexpr std::chrono::milliseconds kLinger{200};
constexpr std::chrono::milliseconds kPublishLimit{300};  // for samples that wait for DDS
// In which the readers of all buses that stop may take their last samples.
constexpr std::chrono::milliseconds kBusLinger{300};
// For the goodbyes to every instance when the whole bridge leaves: those of 10 000 channels may
// take longer on a busy machine, and end with the participant then.
constexpr std::chrono::milliseconds kDisposeLimit{800};
constexpr std::chrono::milliseconds kLastWords{300};  // for the log to be written

struct RunningBus {
  std::unique_ptr<BusOutput> sink;  // outlives the runner, and what it has posted
  std::unique_ptr<IoThread> io;     // outlives the runner too
  std::shared_ptr<BusRunner> runner;
};

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

struct Bridge::State {
  program::Hooks program_hooks();

  BridgeSpec spec;
  bool trace = false;
  CommandAudit audit;
  CommandRouter commands;
  InterestRegistry interests{[](const std::string& text) {
    log_counted(LogLevel::kInfo, "dds", "interests that change nothing", text);
  }};
  DialInRegistry modules;  // outlives the buses and the programming server
  program::Server program{program_hooks(), modules};
  std::mutex store_mutex;  // made and ended on the main thread, used on others too: modules may
                           // come while the whole bridge starts anew
  std::unique_ptr<Store> store;  // outlives the sinks of the buses; null: nothing is stored
  AlarmTable alarms;             // outlives the store's use of it, and the sinks
  std::unique_ptr<Authenticator> logins;          // with a store only
  std::unique_ptr<CommandIdentities> identities;  // the same; closed before the link
  IoThread plans{"plans"};
  std::map<std::string, RunningBus, std::less<>> buses;
  PublisherThread sinks;
  std::unique_ptr<BusGuard> guard;  // outlives the link; its thread ends before the buses do
  std::unique_ptr<DdsLink> link;    // its handlers enter the members above: closed before they end

  std::atomic<const char*> step = "starting";  // what the main thread is at

  tl::expected<void, std::string> start(
      const BridgeSpec& wanted, program::Server::Modules kept,
      const std::function<bool()>& give_up = [] { return false; });
  void join();
  void keep_identities();
  void tell_other_bridges(DdsLink::Handlers& handlers);
  void want_buses(const BridgeSpec& wanted);
  [[nodiscard]] std::vector<std::string> running(std::vector<std::string> names) const;
  void start_buses(const std::vector<std::string>& names, const BridgeSpec& from);
  [[nodiscard]] bool follow_guard(const std::set<std::string>& uncontested);
  void start_bus(const BusSpec& bus);
  void stop_buses(const std::vector<std::string>& names, Duration dispose_limit = Duration::max());
  void stop_all(program::Server::Modules kept = program::Server::Modules::kLetGo);
  [[noreturn]] void abandon(const std::string& bus);
  void configure_alarms(const BridgeSpec& from, const BridgeSpec& to);
  [[nodiscard]] tl::expected<Reloaded, std::string> reload(const BridgeSpec& wanted);

  std::mutex changing;  // of the set of buses: by the main thread, or the guard's
};

program::Hooks Bridge::State::program_hooks() {
  program::Hooks hooks;
  hooks.login = [this](std::string user, std::string password, std::string address,
                       std::function<void(program::LoginAnswer)> done) {
    if (!logins) return done({false, "this bridge has no users: its configuration has no store"});
    logins->authenticate({std::move(user), std::move(password), std::move(address)},
                         [done = std::move(done)](LoginResult result) {
                           if (!result) return done({false, to_text(result.error())});
                           done({may(*result, Role::kProgrammer),
                                 fmt::format("the role {} may not program", to_text(*result))});
                         });
  };
  hooks.audit = [this](const program::Transmission& what) {
    const std::lock_guard lock(store_mutex);
    if (store)
      store->append({{},
                     what.who,
                     "program",
                     what.target,
                     what.bytes_to_device,
                     what.bytes_from_device,
                     what.result});
  };
  hooks.report = [this](const ProgramSessionReport& report) {
    sinks.post([this, report] { link->report(report); });
  };
  return hooks;
}

// Throws DdsError.
void Bridge::State::join() {
  DdsLink::Handlers handlers;
  handlers.clock = [] { return read_clocks(); };
  handlers.on_command = [this](const std::string& bus, Command command) {
    const AuditEntry asked = audit.asked(bus, command);
    if (const auto refused = commands.take(bus, std::move(command), steady_now())) {
      audit.refused(asked, *refused);
      link->complete(bus, *refused, read_clocks());
    }
  };
  handlers.on_interest = [this](const Interest& interest) {
    if (const auto noted = interests.note(interest.station, interest.pattern, interest.refresh);
        !noted) {
      log_counted(LogLevel::kWarning, "dds", "refused interests", noted.error());
    }
  };
  handlers.on_problem = [](const std::string& text) {
    log_counted(LogLevel::kWarning, "dds", "problems with other participants", text);
  };
  tell_other_bridges(handlers);
  link = std::make_unique<DdsLink>(spec.dds, spec.name, std::move(handlers));
  if (spec.store) {
    alarms.expect_store();
    auto opened = std::make_unique<Store>(
        *spec.store, [this](Store& known, const std::vector<AlarmRecord>& active) {
          alarms.loaded(known, active);
        });
    {
      const std::lock_guard lock(store_mutex);
      store = std::move(opened);
    }
    logins = std::make_unique<Authenticator>(StoreAddress(spec.store->address), *store);
    keep_identities();
  }
  audit.open(store.get());
}

void Bridge::State::keep_identities() {
  identities = std::make_unique<CommandIdentities>(StoreAddress(spec.store->address));
  commands.keep_identities(
      [this](const std::string& requester, std::uint64_t request_id, auto kept) {
        identities->enter(requester, request_id,
                          [kept = std::move(kept)](CommandIdentities::Verdict verdict) {
                            switch (verdict) {
                              case CommandIdentities::Verdict::kNew:
                                return kept(CommandRouter::Identity::kNew);
                              case CommandIdentities::Verdict::kKnown:
                                return kept(CommandRouter::Identity::kKnown);
                              case CommandIdentities::Verdict::kNotKept:
                                return kept(CommandRouter::Identity::kNotKept);
                            }
                          });
      },
      [this](const std::string& bus, const CommandResult& refused) {
        audit.answered(bus, refused);
        link->complete(bus, refused, read_clocks());
      });
}

void Bridge::State::tell_other_bridges(DdsLink::Handlers& handlers) {
  guard = std::make_unique<BusGuard>(
      spec.name,
      BusGuard::Handlers{[this](const BridgeClaims& claims) { link->announce(claims); },
                         [this](const auto& uncontested) { return follow_guard(uncontested); },
                         [] { return read_clocks().utc; }});
  BusGuard& others = *guard;
  handlers.bridges = {[&others](const std::string& id) { others.found(id); },
                      [&others](const std::string& id, BridgeClaims claims) {
                        others.receive(id, std::move(claims));
                      },
                      [&others](const std::string& id, bool alive) { others.set_alive(id, alive); },
                      [&others](const std::string& id) { others.lost(id); }};
}

void Bridge::State::want_buses(const BridgeSpec& wanted) {
  std::vector<std::string> names;
  for (const BusSpec& bus : wanted.buses) names.push_back(bus.name);
  guard->want(link->id(), names);
}

std::vector<std::string> Bridge::State::running(std::vector<std::string> names) const {
  std::erase_if(names, [this](const std::string& name) { return !buses.contains(name); });
  return names;
}

// Those that this bridge serves. Throws DdsError.
void Bridge::State::start_buses(const std::vector<std::string>& names, const BridgeSpec& from) {
  for (const BusSpec& bus : from.buses) {
    if (std::find(names.begin(), names.end(), bus.name) == names.end()) continue;
    if (guard->serves(bus.name)) {
      start_bus(bus);
    } else {
      log_error(bus.name, fmt::format("not served here: {} serves a bus of this name in DDS domain "
                                      "{}, where names of buses are unique. This bridge takes it "
                                      "over when that one is gone; else rename one of the two",
                                      guard->rival(bus.name), spec.dds.domain));
      link->listen_for_commands();
    }
  }
}

// What the guard has decided, done: on its thread.
bool Bridge::State::follow_guard(const std::set<std::string>& uncontested) {
  const std::unique_lock lock(changing, std::try_to_lock);
  if (!lock) return false;  // the main thread stops or reloads
  std::vector<std::string> away;
  for (const auto& [name, bus] : buses) {
    if (guard->serves(name)) continue;
    log_error(name, fmt::format("given up: {} serves a bus of this name in DDS domain {} and was "
                                "there first; names of buses are unique in a domain",
                                guard->rival(name), spec.dds.domain));
    away.push_back(name);
  }
  stop_buses(away);
  for (const BusSpec& bus : spec.buses) {
    if (buses.contains(bus.name) || !guard->serves(bus.name)) continue;
    log_warning(bus.name, "taken over: the bridge that served a bus of this name is gone");
    try {
      start_bus(bus);
    } catch (const DdsError& error) { log_error(bus.name, error.what()); }
  }
  for (const std::string& bus : uncontested) link->publish_again(bus);
  return true;
}

// Throws DdsError, and then nothing of the bus is left.
void Bridge::State::start_bus(const BusSpec& bus) {
  FIELDCAST_CHECK(!buses.contains(bus.name));
  RunningBus made;
  made.sink =
      std::make_unique<BusOutput>(BusOutput::Shared{sinks, *link, store.get(), audit, alarms}, bus);
  made.io = std::make_unique<IoThread>(bus.name);
  made.runner =
      std::make_shared<BusRunner>(made.io->context(), plans.context(), bus, *made.sink, &modules);
  commands.add(bus.name,
               made.runner);  // before the bus is announced: its commands may come at once
  try {
    link->add_bus(bus);
  } catch (const DdsError&) {
    commands.remove(bus.name);
    made.runner->stop().wait();  // answers what came meanwhile
    sinks.drain();
    link->remove_bus(bus.name, Duration::zero());
    throw;
  }
  made.runner->set_trace(trace);
  made.runner->start();
  interests.add(bus, made.runner);
  program.add_bus(bus, made.runner);
  buses.emplace(bus.name, std::move(made));
}

void Bridge::State::stop_buses(const std::vector<std::string>& names, Duration dispose_limit) {
  step = "the buses stop";
  const auto deadline = std::chrono::steady_clock::now() + kStopLimit;
  std::vector<std::future<void>> stopped;
  for (const std::string& name : names) {
    program.remove_bus(name);  // nobody asks for its devices any more; a pairing ends with the bus
    interests.remove(name);
    commands.remove(name);  // 1. no more commands come in; whoever sends one hears kShutdown
    stopped.push_back(
        buses.at(name).runner->stop());  // 2. pending commands are answered, the port is closed
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (stopped[i].wait_until(deadline) != std::future_status::ready) abandon(names[i]);
  }
  step = "the last samples leave";
  sinks.drain();  // 3. what they had to say is said
  step = "the buses leave the domain";
  const Instant begun = steady_now(), gone = begun + kBusLinger;
  for (const std::string& name : names) {
    // 4. stations see the bus go
    const Instant now = steady_now();
    link->remove_bus(
        name, std::max(gone - now, Duration::zero()),
        dispose_limit == Duration::max() ? Duration::max() : dispose_limit - (now - begun));
    buses.erase(name);
  }
}

// The order of a shutdown, all of it.
void Bridge::State::stop_all(program::Server::Modules kept) {
  if (!link) return;
  sinks.drop_from(steady_now() + kPublishLimit);
  step = "the engineers are told";
  guard->end();
  program.stop(kept);  // 0. engineers are told, their devices freed
  logins.reset();
  std::vector<std::string> names;
  for (const auto& [name, bus] : buses) names.push_back(name);
  stop_buses(names, kDisposeLimit);     // 1.-4. above, all buses at the same time
  if (identities) identities->close();  // what waited is answered: its bus is gone
  step = "the bridge leaves the domain";
  link->close(kLinger);  // 5. the last results reach their readers, then we leave the domain; no
                         // handler is called afterwards
  link.reset();          // 6.
  guard.reset();
  commands.keep_identities({}, {});
  identities.reset();
  audit.open(nullptr);
  alarms.close(store.get());
  step = "the store is written";
  std::unique_ptr<Store> last;
  {
    const std::lock_guard lock(store_mutex);
    last.swap(store);
  }
  last.reset();  // 7. what waits is written
  sinks.drop_from(kNever);
  interests.forget();  // 8. stations tell their wishes again to whoever joins next
}

// A bus whose thread hangs in a driver (a USB adapter that died in the middle of an ioctl) cannot
// be taken away under its feet. What the others had to say is said; the process ends here, and its
// supervisor starts it anew.
void Bridge::State::abandon(const std::string& bus) {
  log_error(bus, "the bus hangs in its driver and cannot be stopped: the process ends");
  link->close(kLinger);
  if (store) (void)store->flush(kLinger);
  flush_log(kLastWords);
  std::_Exit(static_cast<int>(ExitCode::kInternal));
}

Bridge::Bridge() : state_(std::make_unique<State>()) {}

Bridge::~Bridge() { stop(); }

tl::expected<void, std::string> Bridge::start(const BridgeSpec& spec,
                                              const std::function<bool()>& give_up) {
  const std::lock_guard lock(state_->changing);
  return state_->start(spec, program::Server::Modules::kLetGo, give_up);
}

// `kept`: what becomes of modules that are connected when it fails.
tl::expected<void, std::string> Bridge::State::start(const BridgeSpec& wanted,
                                                     program::Server::Modules kept,
                                                     const std::function<bool()>& give_up) {
  FIELDCAST_CHECK(!link);
  spec = wanted;
  (void)alarms.configure(spec.buses, read_clocks().utc);  // DDS starts anew, and knows of none
  try {
    join();
    want_buses(spec);
    guard->settle(give_up);
    for (const BusSpec& bus : spec.buses) {
      if (give_up()) return {};
      start_buses({bus.name}, spec);
    }
    interests.all_added();
    if (const auto listening = program.start(spec.program); !listening) {
      stop_all(kept);
      return tl::make_unexpected(listening.error());
    }
    guard->watch();
  } catch (const DdsError& error) {
    stop_all(kept);
    return tl::make_unexpected(std::string(error.what()));
  }
  return {};
}

tl::expected<Bridge::Reloaded, std::string> Bridge::reload(const BridgeSpec& wanted) {
  const std::lock_guard lock(state_->changing);
  return state_->reload(wanted);
}

// Alarms whose limit is taken away end, while their bus can still say so.
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

tl::expected<Bridge::Reloaded, std::string> Bridge::State::reload(const BridgeSpec& wanted) {
  if (!link) {  // a reload failed before, and so did the way back
    if (auto started = start(wanted, program::Server::Modules::kKeep); !started)
      return tl::make_unexpected(started.error());
    return Reloaded{};
  }
  const BridgeSpec before = spec;
  const ReloadPlan plan = plan_reload(before, wanted);
  Reloaded waiting;
  for (const auto& held : disturbed_by(plan, wanted, program.held()))
    waiting.waits_for.push_back(fmt::format("{}/{} by {}", held.bus, held.device, held.who));
  if (!waiting.waits_for.empty()) return waiting;
  if (!plan.whole_bridge.empty()) {
    log_info(before.name,
             fmt::format("reloading: {}: everything starts anew: {} buses, the participant "
                         "in DDS domain {}{}{}",
                         fmt::join(plan.whole_bridge, ", "), before.buses.size(), before.dds.domain,
                         before.store ? ", the store" : "",
                         before.program == ProgramSpec{} ? "" : ", the programming server"));
    stop_all(program::Server::Modules::kKeep);
    auto started = start(wanted, program::Server::Modules::kKeep);
    if (started) {
      log_info(wanted.name,
               fmt::format("reloaded: everything started anew: {} buses, DDS domain {}",
                           wanted.buses.size(), wanted.dds.domain));
      return Reloaded{};
    }
    if (auto back = start(before, program::Server::Modules::kKeep); !back)
      return tl::make_unexpected(fmt::format("{}; and then {}", started.error(), back.error()));
    return tl::make_unexpected(started.error());
  }
  if (plan.program) {
    log_info(before.name, "reloading: the programming server starts anew; modules stay connected");
    program.stop(program::Server::Modules::kKeep);
    if (const auto listening = program.start(wanted.program); !listening) {
      (void)program.start(before.program);
      return tl::make_unexpected(listening.error());
    }
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
  spec = wanted;
  const auto names = [](const std::vector<std::string>& listed) {
    return listed.empty() ? std::string{} : fmt::format(" ({})", fmt::join(listed, ", "));
  };
  log_info(wanted.name, fmt::format("reloaded: {} buses stopped{}, {} started{}, {} untouched",
                                    plan.stop.size(), names(plan.stop), plan.start.size(),
                                    names(plan.start), plan.untouched.size()));
  return Reloaded{};
}

void Bridge::set_trace(bool on) {
  const std::lock_guard lock(state_->changing);
  state_->trace = on;
  for (auto& [name, bus] : state_->buses) bus.runner->set_trace(on);
}

void Bridge::stop() {
  const std::lock_guard lock(state_->changing);
  state_->stop_all();
}

std::string Bridge::busy_with() const { return state_->step.load(); }

void Bridge::save(Duration limit) {
  const std::lock_guard lock(state_->store_mutex);
  if (state_->store) (void)state_->store->flush(limit);
}

}  // namespace fieldcast
