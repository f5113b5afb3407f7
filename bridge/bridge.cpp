#include "bridge/bridge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <future>
#include <map>
#include <vector>

#include "bridge/bus_runner.hpp"
#include "bridge/check.hpp"
#include "bridge/clock.hpp"
#include "bridge/command_audit.hpp"
#include "bridge/command_desk.hpp"
#include "bridge/dds/dds_link.hpp"
#include "bridge/dds_outlet.hpp"
#include "bridge/exit_code.hpp"
#include "bridge/interest_desk.hpp"
#include "bridge/io_thread.hpp"
#include "bridge/log.hpp"
#include "bridge/outlet_thread.hpp"
#include "bridge/port/dial_in_registry.hpp"
#include "bridge/program/server.hpp"
#include "bridge/reload_plan.hpp"
#include "bridge/repeat_filter.hpp"
#include "bridge/store/login_desk.hpp"
#include "bridge/store/store.hpp"

namespace fieldcast {
namespace {

// For all buses together, so that a stop ends within two seconds.
constexpr std::chrono::milliseconds kStopLimit{1200};
constexpr std::chrono::milliseconds kLinger{200};

struct RunningBus {
  std::unique_ptr<DdsOutlet> outlet;  // outlives the runner, and what it has posted
  std::unique_ptr<IoThread> io;       // outlives the runner too
  std::shared_ptr<BusRunner> runner;
};

}  // namespace

struct Bridge::State {
  program::Hooks program_hooks();

  BridgeSpec spec;
  bool trace = false;
  CommandAudit audit;
  CommandDesk commands;
  InterestDesk interests{[](const std::string& text) { log_info("dds", text); }};
  DialInRegistry modules;  // outlives the buses and the programming server
  program::Server program{program_hooks(), modules};
  std::unique_ptr<Store> store;       // outlives the outlets of the buses; null: nothing is stored
  std::unique_ptr<LoginDesk> logins;  // with a store only
  RepeatFilter refused_interests;
  IoThread plans{"plans"};
  std::map<std::string, RunningBus, std::less<>> buses;
  OutletThread outlets;
  std::unique_ptr<DdsLink> link;  // its handlers enter the members above: closed before they end

  void join();
  void start_bus(const BusSpec& bus);
  void stop_buses(const std::vector<std::string>& names);
  void stop_all();
  [[noreturn]] void abandon(const std::string& bus);
  void restart(const std::vector<std::string>& names, const BridgeSpec& from);
};

program::Hooks Bridge::State::program_hooks() {
  program::Hooks hooks;
  hooks.login = [this](std::string user, std::string password, std::string address,
                       std::function<void(program::LoginAnswer)> done) {
    if (!logins) return done({false, "this bridge has no users: its configuration has no store"});
    logins->authenticate({std::move(user), std::move(password), std::move(address)},
                         [done = std::move(done)](LoginResult result) {
                           if (!result) return done({false, to_text(result.error())});
                           done({may(*result, Role::kProgrammer), fmt::format("the role {} may not program", to_text(*result))});
                         });
  };
  hooks.audit = [this](const program::Transmission& what) {
    if (store) store->append({{}, what.who, "program", what.target, what.bytes_to_device, what.bytes_from_device, what.result});
  };
  hooks.report = [this](const ProgramSessionReport& report) { outlets.post([this, report] { link->report(report); }); };
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
    if (const auto noted = interests.note(interest.station, interest.pattern, interest.refresh); !noted) {
      // One at a time: the receiver of interests sees to it.
      const auto verdict = refused_interests.occurred("interest", steady_now());
      if (!verdict.log) return;
      const std::string more = verdict.suppressed == 0 ? "" : " (" + std::to_string(verdict.suppressed) + " more were refused)";
      log_warning("dds", noted.error() + more);
    }
  };
  handlers.on_problem = [](const std::string& text) { log_warning("dds", text); };
  link = std::make_unique<DdsLink>(spec.dds, spec.name, std::move(handlers));
  if (spec.store) {
    store = std::make_unique<Store>(*spec.store);
    logins = std::make_unique<LoginDesk>(StoreAddress(spec.store->address), *store);
  }
  audit.open(store.get());
}

// Throws DdsError, and then nothing of the bus is left.
void Bridge::State::start_bus(const BusSpec& bus) {
  FIELDCAST_CHECK(!buses.contains(bus.name));
  RunningBus made;
  made.outlet = std::make_unique<DdsOutlet>(outlets, *link, store.get(), audit, bus);
  made.io = std::make_unique<IoThread>(bus.name);
  made.runner = std::make_shared<BusRunner>(made.io->context(), plans.context(), bus, *made.outlet, &modules);
  commands.add(bus.name, made.runner);  // before the bus is announced: its commands may come at once
  try {
    link->add_bus(bus);
  } catch (const DdsError&) {
    commands.remove(bus.name);
    made.runner->stop().wait();  // answers what came meanwhile
    outlets.drain();
    link->remove_bus(bus.name);
    throw;
  }
  made.runner->set_trace(trace);
  made.runner->start();
  interests.add(bus, made.runner);
  program.add_bus(bus, made.runner);
  buses.emplace(bus.name, std::move(made));
}

void Bridge::State::stop_buses(const std::vector<std::string>& names) {
  const auto deadline = std::chrono::steady_clock::now() + kStopLimit;
  std::vector<std::future<void>> stopped;
  for (const std::string& name : names) {
    program.remove_bus(name);  // nobody asks for its devices any more; a pairing ends with the bus
    interests.remove(name);
    commands.remove(name);                             // 1. no more commands come in; whoever sends one hears kShutdown
    stopped.push_back(buses.at(name).runner->stop());  // 2. pending commands are answered, the port is closed
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (stopped[i].wait_until(deadline) != std::future_status::ready) abandon(names[i]);
  }
  outlets.drain();  // 3. what they had to say is said
  for (const std::string& name : names) {
    link->remove_bus(name);  // 4. stations see the bus go
    buses.erase(name);
  }
}

// The order of a shutdown, all of it.
void Bridge::State::stop_all() {
  if (!link) return;
  program.stop();  // 0. engineers are told, their devices freed
  logins.reset();
  std::vector<std::string> names;
  for (const auto& [name, bus] : buses) names.push_back(name);
  stop_buses(names);     // 1.-4. above, all buses at the same time
  link->close(kLinger);  // 5. the last results reach their readers, then we leave the domain; no handler is called afterwards
  link.reset();          // 6.
  audit.open(nullptr);
  store.reset();       // 7. what waits is written
  interests.forget();  // 8. stations tell their wishes again to whoever joins next
}

// A bus whose thread hangs in a driver (a USB adapter that died in the middle of an ioctl) cannot be taken away under its feet.
// What the others had to say is said; the process ends here, and its supervisor starts it anew.
void Bridge::State::abandon(const std::string& bus) {
  log_error(bus, "the bus hangs in its driver and cannot be stopped: the process ends");
  link->close(kLinger);
  if (store) (void)store->flush(kLinger);
  std::_Exit(static_cast<int>(ExitCode::kInternal));
}

Bridge::Bridge() : state_(std::make_unique<State>()) {}

Bridge::~Bridge() { stop(); }

tl::expected<void, std::string> Bridge::start(const BridgeSpec& spec) {
  FIELDCAST_CHECK(!state_->link);
  state_->spec = spec;
  try {
    state_->join();
    for (const BusSpec& bus : spec.buses) state_->start_bus(bus);
    state_->interests.all_added();
    if (const auto listening = state_->program.start(spec.program); !listening) {
      state_->stop_all();
      return tl::make_unexpected(listening.error());
    }
  } catch (const DdsError& error) {
    state_->stop_all();
    return tl::make_unexpected(std::string(error.what()));
  }
  return {};
}

void Bridge::State::restart(const std::vector<std::string>& names, const BridgeSpec& from) {
  for (const BusSpec& bus : from.buses) {
    if (std::find(names.begin(), names.end(), bus.name) != names.end()) start_bus(bus);
  }
}

tl::expected<void, std::string> Bridge::reload(const BridgeSpec& wanted) {
  State& s = *state_;
  if (!s.link) return start(wanted);  // a reload failed before, and so did the way back
  const BridgeSpec before = s.spec;
  const ReloadPlan plan = plan_reload(before, wanted);
  if (plan.whole_bridge) {
    s.stop_all();
    auto started = start(wanted);
    if (started) return {};
    if (auto back = start(before); !back)
      return tl::make_unexpected(fmt::format("{}; and then {}", started.error(), back.error()));
    return started;
  }
  if (plan.program) {
    s.program.stop();
    if (const auto listening = s.program.start(wanted.program); !listening) {
      (void)s.program.start(before.program);
      return tl::make_unexpected(listening.error());
    }
  }
  s.stop_buses(plan.stop);
  try {
    s.restart(plan.start, wanted);
  } catch (const DdsError& error) {
    std::vector<std::string> begun;
    for (const std::string& name : plan.start) {
      if (s.buses.contains(name)) begun.push_back(name);
    }
    s.stop_buses(begun);
    if (plan.program) {
      s.program.stop();
      (void)s.program.start(before.program);
    }
    s.restart(plan.stop, before);
    return tl::make_unexpected(std::string(error.what()));
  }
  s.spec = wanted;
  log_info(wanted.name, fmt::format("reloaded: {} buses stopped, {} started, {} untouched", plan.stop.size(), plan.start.size(),
                                    plan.untouched.size()));
  return {};
}

void Bridge::set_trace(bool on) {
  state_->trace = on;
  for (auto& [name, bus] : state_->buses) bus.runner->set_trace(on);
}

void Bridge::stop() { state_->stop_all(); }

}  // namespace fieldcast
