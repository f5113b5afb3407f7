// The handlers of DDS, the programming server, the store and the other bridges.
#include <fmt/format.h>

#include "bridge/base/clock.hpp"
#include "bridge/bridge.hpp"
#include "bridge/dds/guard/datagram_guard.hpp"
#include "bridge/dds/transport/network_check.hpp"
#include "bridge/log/log.hpp"

namespace fieldcast {

Bridge::Bridge(OnConfiguration on_configuration)
    : on_configuration_(std::move(on_configuration)),
      interests_([](const std::string& text) {
        log_counted(LogLevel::kInfo, "dds", "interests that change nothing", text);
      }),
      program_(program_hooks(), modules_),
      commands_(
          router_, audit_, alarms_, lease_, roles_,
          [this](const std::string& bus, const std::string& device, const std::string& reason) {
            return program_.end_session(bus, device, reason);
          }) {}

Bridge::OpenStore::OpenStore(const StoreSpec& spec, AlarmTable& alarms)
    : store(spec, [&alarms](Store& known, const KeptAlarms& kept) { alarms.loaded(known, kept); }),
      logins(StoreAddress(spec.address), store),
      identities(StoreAddress(spec.address)) {}

program::Hooks Bridge::program_hooks() {
  program::Hooks hooks;
  const auto verdict = [](std::function<void(program::LoginResponse)> done) {
    return [done = std::move(done)](const LoginResult& result) {
      if (!result) return done({false, to_text(result.error())});
      done({may(result->role, Role::kProgrammer),
            fmt::format("the role {} may not program", to_text(result->role))});
    };
  };
  // Without a store, the certificate authority decides which users are engineers.
  hooks.certified = [this, verdict](std::string user, std::string address,
                                    std::function<void(program::LoginResponse)> done) {
    if (!store_) return done({true, ""});
    store_->logins.authenticate(
        {.user = std::move(user), .peer = std::move(address), .certified = true},
        verdict(std::move(done)));
  };
  hooks.login = [this, verdict](std::string user, Secret password, std::string address,
                                std::function<void(program::LoginResponse)> done) {
    if (!store_) return done({false, "this bridge has no users: its configuration has no store"});
    store_->logins.authenticate({std::move(user), std::move(password), std::move(address)},
                                verdict(std::move(done)));
  };
  hooks.audit = [this](const program::Transmission& what) {
    audit_.note({{},
                 what.who,
                 "program",
                 what.target,
                 what.bytes_to_device,
                 what.bytes_from_device,
                 what.result});
  };
  hooks.report = [this](const ProgramSessionReport& report) {
    sinks_.post([this, report] { link_->report(report); });
  };
  hooks.requested = [this](const ProgramRequestReport& report) {
    sinks_.post([this, report] { link_->report(report); });
  };
  return hooks;
}

DdsLink::Handlers Bridge::link_handlers() {
  DdsLink::Handlers handlers;
  handlers.clock = [] { return read_clocks(); };
  handlers.on_command = [this](const std::string& bus, Command command, std::string late) {
    commands_.receive(bus, std::move(command), std::move(late));
  };
  handlers.on_alarm_action = [this](const AlarmAction& action) { commands_.receive(action); };
  handlers.on_rejected = [this](const std::string& bus, const Command& asked,
                                const CommandResult& result) {
    AuditEntry entry = audit_entry(bus, asked);
    entry.what = "request";
    audit_.note(std::move(entry), result);
  };
  handlers.on_interest = [this](const Interest& interest) {
    if (const auto noted = interests_.note(interest.station, interest.pattern, interest.refresh);
        !noted) {
      log_counted(LogLevel::kWarning, "dds", "refused interests", noted.error());
    }
  };
  handlers.on_problem = [](const std::string& text) {
    log_counted(LogLevel::kWarning, "dds", "problems with other participants", text);
  };
  handlers.on_history = [this](HistoryRequest request, std::string fault) {
    HistoryService* const history = receives_history_;
    if (history != nullptr) history->receive(std::move(request), std::move(fault));
  };
  handlers.on_configuration = on_configuration_;
  handlers.on_readers = [this] { readers_came_ = true; };
  handlers.bridges = {[this](const std::string& id) { guard_->found(id); },
                      [this](const std::string& id, BridgeClaims claims) {
                        guard_->receive(id, std::move(claims));
                      },
                      [this](const std::string& id, bool alive) { guard_->set_alive(id, alive); },
                      [this](const std::string& id) { guard_->lost(id); }};
  return handlers;
}

BusGuard::Handlers Bridge::guard_handlers() {
  BusGuard::Handlers handlers;
  handlers.announce = [this](const BridgeClaims& claims) { link_->announce(claims); };
  handlers.changed = [this](const std::set<std::string>& uncontested) {
    const std::unique_lock lock(changing_, std::try_to_lock);
    if (!lock) return false;  // the main thread stops or reloads
    if (membership_ && membership_->is_pausing()) return false;
    buses_->follow_guard(uncontested);
    return true;
  };
  handlers.finding = [this] {
    const std::size_t servers = spec_.dds.discovery_servers.size();
    return Finding{servers > 0, link_->missing_servers().size() < servers, link_->unknown_bridges(),
                   0};
  };
  handlers.members = [this] {
    return membership_ ? membership_->others() : std::vector<std::string>{};
  };
  handlers.waits = [this](const std::string& what) {
    const Duration most = membership_ ? Settling::kMostInGroup : Settling::kMost;
    log_info(spec_.name, fmt::format("serves nothing yet, and waits for {}; at most {} in all",
                                     what, to_text(most)));
    if (membership_) membership_->set_not_ready("it waits for " + what);
  };
  handlers.unheard = [this](std::size_t bridges) {
    log_warning(spec_.name,
                fmt::format("{} bridges are in DDS domain {} and say nothing that this one can "
                            "read: they may have died a moment ago, or dds: security: is not the "
                            "same there and here",
                            bridges, spec_.dds.domain));
  };
  return handlers;
}

void Bridge::join() {
  guard_ = std::make_unique<BusGuard>(spec_.name, guard_handlers());
  link_ = std::make_unique<DdsLink>(spec_.dds, spec_.name, link_handlers());
  history_ = std::make_unique<HistoryService>(
      spec_.store,
      HistoryService::Uses{[this](const std::string& bus) { return link_->epoch_of(bus) != 0; },
                           [this](const HistoryRequest& request, const HistoryResponse& response) {
                             link_->respond(request, response);
                           }});
  receives_history_ = history_.get();
  if (const auto small = receive_buffer_remark(spec_.dds)) log_warning("dds", *small);
  if (const auto alone = multicast_remark(spec_.dds)) log_warning("dds", *alone);
  publish_alarms();
  if (spec_.store) {
    alarms_.expect_store();
    auto opened = std::make_unique<OpenStore>(*spec_.store, alarms_);
    const std::lock_guard lock(store_mutex_);
    store_ = std::move(opened);
  }
  Store* const store = store_ ? &store_->store : nullptr;
  published_audit_ = std::make_unique<AuditPublisher>(
      spec_.name, store, [this](const AuditReport& entry) { link_->report(entry); });
  audit_.open(published_audit_.get());
  buses_ =
      std::make_unique<BusSet>(BusSet::Uses{{sinks_, *link_, store, audit_, commands_, alarms_,
                                             inputs_, figures_, lease_, spec_.standby.has_value()},
                                            *guard_,
                                            router_,
                                            interests_,
                                            program_,
                                            modules_,
                                            plans_,
                                            step_},
                               spec_, trace_);
  if (spec_.standby) {
    membership_ =
        std::make_unique<Membership>(Membership::Uses{*link_, *guard_, *buses_, commands_, alarms_,
                                                      lease_, roles_, readers_came_},
                                     spec_, memory_);
  } else {
    lease_.set(kNever);
  }
  commands_.open(*link_, store_ ? &store_->identities : nullptr);
}

// The task reads the status when it runs, so the last of several changes is published.
void Bridge::publish_alarms() {
  alarms_.publish_with([this](const AlarmKey& alarm) {
    sinks_.post([this, alarm] {
      if (const auto status = alarms_.status_of(alarm)) {
        link_->report(alarm, *status);
      } else {
        link_->forget(alarm);
      }
    });
  });
}

// Replaces the previous server. A server that cannot listen retries; start and reload succeed.
void Bridge::serve_metrics(const BridgeSpec& wanted) {
  metrics_.reset();
  if (!wanted.metrics) return;
  const auto buffer = wanted.dds.profile ? std::nullopt : granted_receive_buffer();
  metrics_ = std::make_unique<MetricsServer>(
      wanted.metrics->listen,
      [this, name = wanted.name, buffer](MetricsFormat format) {
        MetricsSnapshot snapshot{
            .bridge = name, .refused_datagrams = refused_datagrams(), .receive_buffer = buffer};
        figures_.copy_to(snapshot);
        snapshot.alarms = alarms_.counts();
        if (membership_) snapshot.standby = membership_->figures();
        if (store_) snapshot.store = store_->store.counters();
        return metrics_text(snapshot, format);
      },
      [this] {
        MetricsSnapshot snapshot;
        figures_.copy_to(snapshot);
        return silent_bus(snapshot, steady_now());
      });
}

}  // namespace fieldcast
