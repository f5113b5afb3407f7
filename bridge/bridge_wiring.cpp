// The handlers of DDS, the programming server, the store and the other bridges.
#include <fmt/format.h>

#include "bridge/base/clock.hpp"
#include "bridge/bridge_state.hpp"
#include "bridge/dds/guard/datagram_guard.hpp"
#include "bridge/dds/transport/network_check.hpp"

namespace fieldcast {

program::Hooks Bridge::State::program_hooks() {
  program::Hooks hooks;
  const auto verdict = [](std::function<void(program::LoginResponse)> done) {
    return [done = std::move(done)](const LoginResult& result) {
      if (!result) return done({false, to_text(result.error())});
      done({may(*result, Role::kProgrammer),
            fmt::format("the role {} may not program", to_text(*result))});
    };
  };
  // Without a store, the certificate authority decides which users are engineers.
  hooks.certified = [this, verdict](std::string user, std::string address,
                                    std::function<void(program::LoginResponse)> done) {
    if (!logins) return done({true, ""});
    logins->authenticate({.user = std::move(user), .peer = std::move(address), .certified = true},
                         verdict(std::move(done)));
  };
  hooks.login = [this, verdict](std::string user, Secret password, std::string address,
                                std::function<void(program::LoginResponse)> done) {
    if (!logins) return done({false, "this bridge has no users: its configuration has no store"});
    logins->authenticate({std::move(user), std::move(password), std::move(address)},
                         verdict(std::move(done)));
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
  handlers.on_command = [this](const std::string& bus, Command command, std::string late) {
    if (standby.hold(bus, command)) return;
    run_command(bus, std::move(command), std::move(late));
  };
  handlers.on_alarm_action = [this](const AlarmAction& action) {
    if (standby.hold(action)) return;
    run_action(action);
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
  handlers.on_readers = [this] { standby.readers_came = true; };
  tell_other_bridges(handlers);
  link = std::make_unique<DdsLink>(spec.dds, spec.name, std::move(handlers));
  if (const auto small = receive_buffer_remark(spec.dds)) log_warning("dds", *small);
  if (const auto alone = multicast_remark(spec.dds)) log_warning("dds", *alone);
  publish_alarms();
  spec.standby ? join_group() : stand_alone();
  if (spec.store) open_store();
  audit.open(store.get());
}

void Bridge::State::open_store() {
  alarms.expect_store();
  auto opened = std::make_unique<Store>(
      *spec.store, [this](Store& known, const KeptAlarms& kept) { alarms.loaded(known, kept); });
  {
    const std::lock_guard lock(store_mutex);
    store = std::move(opened);
  }
  logins = std::make_unique<Authenticator>(StoreAddress(spec.store->address), *store);
  identities = std::make_unique<CommandIdTable>(StoreAddress(spec.store->address));
}

// The task reads the status when it runs, so the last of several changes is published.
void Bridge::State::publish_alarms() {
  alarms.publish_with([this](const AlarmKey& alarm) {
    sinks.post([this, alarm] {
      if (const auto status = alarms.status_of(alarm)) {
        link->report(alarm, *status);
      } else {
        link->forget(alarm);
      }
    });
  });
}

// Replaces the previous server. A server that cannot listen retries; start and reload succeed.
void Bridge::State::serve_metrics(const BridgeSpec& wanted) {
  metrics.reset();
  if (!wanted.metrics) return;
  const auto buffer = wanted.dds.profile ? std::nullopt : granted_receive_buffer();
  metrics = std::make_unique<MetricsServer>(
      wanted.metrics->listen, [this, name = wanted.name, buffer](MetricsFormat format) {
        MetricsSnapshot snapshot{
            .bridge = name, .refused_datagrams = refused_datagrams(), .receive_buffer = buffer};
        figures.copy_to(snapshot);
        snapshot.alarms = alarms.counts();
        if (group) snapshot.standby = standby_figures();
        {
          const std::lock_guard lock(store_mutex);
          if (store) snapshot.store = store->counters();
        }
        return metrics_text(snapshot, format);
      });
}

void Bridge::State::tell_other_bridges(DdsLink::Handlers& handlers) {
  guard = std::make_unique<BusGuard>(
      spec.name, BusGuard::Handlers{
                     [this](const BridgeClaims& claims) { link->announce(claims); },
                     [this](const auto& uncontested) { return follow_guard(uncontested); },
                     [] { return read_clocks().utc; },
                     [this] {
                       const std::size_t servers = spec.dds.discovery_servers.size();
                       return Finding{servers > 0, link->missing_servers().size() < servers,
                                      link->unknown_bridges(), 0};
                     },
                     [this] { return group ? group->view().others : std::vector<std::string>{}; },
                     [this](const std::string& what) { say_waits_for(what); },
                     [this](std::size_t bridges) { say_unheard(bridges); }});
  BusGuard& others = *guard;
  handlers.bridges = {[&others](const std::string& id) { others.found(id); },
                      [&others](const std::string& id, BridgeClaims claims) {
                        others.receive(id, std::move(claims));
                      },
                      [&others](const std::string& id, bool alive) { others.set_alive(id, alive); },
                      [&others](const std::string& id) { others.lost(id); }};
}

}  // namespace fieldcast
