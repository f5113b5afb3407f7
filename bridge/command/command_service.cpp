#include "bridge/command/command_service.hpp"

#include <optional>

#include "bridge/base/clock.hpp"

namespace fieldcast {
namespace {

// Result of a command that this bridge does not run. `begun`: another bridge had started it.
CommandResult unfinished(const std::string& requester, std::uint64_t request_id, bool begun) {
  CommandResult result;
  result.requester = requester;
  result.request_id = request_id;
  result.state = begun ? CommandState::kFailed : CommandState::kRejected;
  // kRejected with kShutdown proves to stations that the command did not run; they send it again.
  result.cause = Cause::kShutdown;
  result.reason = begun ? "the bridge that had begun it has left; unknown whether it took effect"
                        : "no bridge of the group was master when it came, and it did not reach "
                          "the present one: it was not run, send it again";
  result.received = result.started = result.completed = steady_now();
  return result;
}

}  // namespace

void CommandService::join(StandbyGroup& group) {
  held_commands_.join();
  held_actions_.join();
  handing_over_ = false;
  in_hand_ = 0;
  group_ = &group;
}

void CommandService::open(DdsLink& link, CommandIdTable* identities) {
  link_ = &link;
  identities_ = identities;
}

void CommandService::close() {
  link_ = nullptr;
  group_ = nullptr;
  identities_ = nullptr;
}

void CommandService::receive(const std::string& bus, Command command, std::string late) {
  const Instant now = steady_now();
  if (group_ && (held_commands_.hold(bus, {command.requester, command.request_id}, {bus, command},
                                     command.expires, now) ||
                 router_.was_completed_elsewhere(command, now)))
    return;
  const AuditEntry asked = audit_.asked(bus, command);
  if (group_) ++in_hand_;
  std::optional<CommandResult> refused = router_.deduplicate(command, now, std::move(late));
  if (!refused && CommandRouter::must_be_noted(command) && (group_ || identities_))
    return run_noted(bus, command, now);
  if (!refused) refused = router_.route(bus, command, CommandRouter::Identity::kNew, now);
  if (!refused) return;
  audit_.refused(asked, *refused);
  if (!keeps_result(bus, *refused)) publish(bus, *refused);
}

void CommandService::set_gateway(const std::string& bus, Done done) {
  const std::lock_guard lock(gateways_mutex_);
  gateways_.erase(bus);
  if (done) gateways_.emplace(bus, std::move(done));
}

bool CommandService::is_of_gateway(const std::string& bus, const CommandResult& result) {
  if (!result.gateway) return false;
  const std::lock_guard lock(gateways_mutex_);
  if (const auto found = gateways_.find(bus); found != gateways_.end()) found->second(result);
  return result.gateway_read;
}

void CommandService::publish(const std::string& bus, const CommandResult& result) {
  if (!is_of_gateway(bus, result)) link_->complete(bus, result, read_clocks());
}

void CommandService::run_noted(const std::string& bus, const Command& command, Instant received) {
  const auto run = [this, bus, command, received](CommandRouter::Identity identity) {
    const auto refused = router_.route(bus, command, identity, received);
    if (!refused || keeps_result(bus, *refused)) return;
    audit_.completed(bus, *refused);
    publish(bus, *refused);
  };
  const auto keep = [this, run, requester = command.requester, id = command.request_id] {
    identities_ ? identities_->enter(requester, id, run) : run(CommandRouter::Identity::kNew);
  };
  if (!group_) return keep();
  group_->begin(bus, command.requester, command.request_id, [keep, run](bool noted) {
    noted ? keep() : run(CommandRouter::Identity::kNotNoted);
  });
}

void CommandService::receive(const AlarmAction& action) {
  const Instant now = steady_now();
  if (!group_ || !held_actions_.hold(action.alarm.bus, {action.requester, action.request_id},
                                     action, now + std::chrono::seconds{10}, now))
    run(action);
}

void CommandService::run(const AlarmAction& action) {
  const UtcMapping now = read_clocks();
  note_result(action.requester, action.request_id);
  link_->complete(action.alarm.bus, actions_.take(action, now), now);
}

bool CommandService::keeps_result(const std::string& bus, const CommandResult& result) {
  if (!group_) return false;
  if (--in_hand_ == 0 && handing_over_) roles_.notify();
  const bool rejected = result.state == CommandState::kRejected;
  if (handing_over_ && rejected && result.cause == Cause::kShutdown) {
    group_->give_back(bus, result.requester, result.request_id);
    return true;
  }
  // Members that cannot receive each other: the one that uses the wire responds.
  if (rejected && result.cause == Cause::kForeignMaster) return true;
  return keep_late(bus, result);
}

// Keeps the result while the lease is not held, because the master is then unknown.
bool CommandService::keep_late(const std::string& bus, const CommandResult& result) {
  if (lease_.holds()) {
    note_result(result.requester, result.request_id);
    return false;
  }
  const std::lock_guard lock(late_mutex_);
  late_.emplace_back(bus, result);
  roles_.notify();
  return true;
}

void CommandService::respond(const std::string& bus, const CommandResult& result) {
  audit_.completed(bus, result);
  note_result(result.requester, result.request_id);
  publish(bus, result);
}

void CommandService::note_result(const std::string& requester, std::uint64_t request_id) {
  const std::lock_guard lock(with_result_mutex_);
  with_result_.note({requester, request_id}, steady_now());
}

bool CommandService::has_result(const std::string& requester, std::uint64_t request_id) {
  const std::lock_guard lock(with_result_mutex_);
  return with_result_.lately({requester, request_id}, steady_now());
}

void CommandService::seen_result(const std::string& requester, std::uint64_t request_id) {
  const bool waits = held_commands_.waits();
  held_commands_.completed({requester, request_id});
  if (waits) roles_.notify();
  held_actions_.completed({requester, request_id});
  note_result(requester, request_id);
  router_.completed_elsewhere(requester, request_id, steady_now());
}

void CommandService::note(const StandbyNote& note) {
  switch (note.kind) {
    case StandbyNoteKind::kBegun:
      return held_commands_.begun(note.bus, {note.requester, note.request_id},
                                  steady_now() + std::chrono::minutes{1});
    case StandbyNoteKind::kReturned:
      held_commands_.returned({note.requester, note.request_id});
      return roles_.notify();
    case StandbyNoteKind::kCompleted: return seen_result(note.requester, note.request_id);
  }
}

// Repeats a result that the other member missed. Ignores requests before this bridge has taken
// over: the member reports them again.
void CommandService::resolve_unknown(const StandbyNote& held) {
  if (!held_commands_.runs() || !held_actions_.runs()) return;
  // A requester numbers its commands and its alarm actions together.
  const bool command = router_.completed_elsewhere(held.requester, held.request_id, steady_now());
  const bool action = actions_.completed_elsewhere(held.requester, held.request_id);
  if (!command || !action) {
    if (has_result(held.requester, held.request_id))
      group_->tell_completed(held.bus, held.requester, held.request_id);
    return;
  }
  const CommandResult result =
      unfinished(held.requester, held.request_id, held.kind == StandbyNoteKind::kBegun);
  if (!keep_late(held.bus, result)) respond(held.bus, result);
}

void CommandService::run_held() {
  const Instant now = steady_now();
  for (Held& held : held_commands_.take_over(now)) receive(held.bus, std::move(held.command));
  for (const AlarmAction& action : held_actions_.take_over(now)) run(action);
}

void CommandService::finish_begun() {
  (void)roles_.wait_until(steady_now() + HeldCommands<Held>::kLastWords,
                          [this] { return !held_commands_.waits(); });
  auto left = held_commands_.give_up();
  for (Held& held : left.to_run) receive(held.bus, std::move(held.command));
  for (const auto& [bus, key] : left.begun) {
    router_.completed_elsewhere(key.first, key.second, steady_now());
    const CommandResult failed = unfinished(key.first, key.second, true);
    if (!keep_late(bus, failed)) respond(bus, failed);
  }
}

void CommandService::finish_late() {
  if (!lease_.holds()) return;
  std::vector<std::pair<std::string, CommandResult>> late;
  {
    const std::lock_guard lock(late_mutex_);
    late.swap(late_);
  }
  for (const auto& [bus, result] : late) respond(bus, result);
}

bool CommandService::has_late() {
  const std::lock_guard lock(late_mutex_);
  return !late_.empty();
}

void CommandService::hand_over(Duration limit) {
  handing_over_ = true;
  held_commands_.stand_by();
  held_actions_.stand_by();
  (void)roles_.wait_until(steady_now() + limit, [this] { return in_hand_ == 0; });
}

void CommandService::handed_over() {
  const std::lock_guard lock(late_mutex_);
  late_.clear();
  handing_over_ = false;
}

void CommandService::report_held(bool leaving) {
  const StandbyGroup::View view = group_->view();
  if (view.role != StandbyRole::kWaiting || !view.master) return;
  const Instant now = steady_now();
  const auto report = [&](auto& held) {
    for (const auto& [bus, key, begun] :
         leaving ? held.last_words(now) : held.without_result(view.term, now))
      group_->tell_held(bus, key.first, key.second, begun);
  };
  report(held_commands_);
  report(held_actions_);
}

}  // namespace fieldcast
