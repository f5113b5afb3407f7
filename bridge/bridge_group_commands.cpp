// Commands in a standby group. A waiting member holds them; the master notes which writes begin; a
// new master responds for a lost one.
#include "bridge/base/clock.hpp"
#include "bridge/bridge_state.hpp"

namespace fieldcast {
namespace {

// Result of a command that this bridge does not run. `begun`: another bridge had started it.
CommandResult unfinished(const std::string& requester, std::uint64_t request_id, bool begun,
                         Instant now) {
  CommandResult result;
  result.requester = requester;
  result.request_id = request_id;
  result.state = begun ? CommandState::kFailed : CommandState::kRejected;
  // kRejected with kShutdown proves to stations that the command did not run; they send it again.
  result.cause = Cause::kShutdown;
  result.reason = begun ? "the bridge that had begun it has left; unknown whether it took effect"
                        : "no bridge of the group was master when it came, and it did not reach "
                          "the present one: it was not run, send it again";
  result.received = result.started = result.completed = now;
  return result;
}

}  // namespace

// Runs commands that the old master has not started.
void Bridge::State::run_held() {
  const Instant now = steady_now();
  for (Standby::HeldCommand& held : standby.commands.take_over(now))
    run_command(held.bus, std::move(held.command));
  for (const AlarmAction& action : standby.actions.take_over(now)) run_action(action);
}

// Waits for the results of commands that the old master had started; they may still arrive.
void Bridge::State::finish_begun() {
  (void)standby.wait_until(steady_now() + HeldCommands<Standby::HeldCommand>::kLastWords,
                           [this] { return !standby.commands.waits(); });
  auto left = standby.commands.give_up();
  for (Standby::HeldCommand& held : left.to_run) run_command(held.bus, std::move(held.command));
  const Instant now = steady_now();
  for (const auto& [bus, key] : left.begun) {
    commands.answered_elsewhere(key.first, key.second, now);
    const CommandResult failed = unfinished(key.first, key.second, true, now);
    if (!keep_late(bus, failed)) answer_held(bus, failed);
  }
}

// At a waiting member: reports held commands that the master may not have received.
void Bridge::State::tell_held() {
  if (!group) return;
  const StandbyGroup::View view = group->view();
  if (view.role != StandbyRole::kWaiting || !view.master) return;
  const auto tell = [this](const auto& unanswered) {
    for (const auto& [bus, key, begun] : unanswered)
      group->tell_held(bus, key.first, key.second, begun);
  };
  tell(standby.commands.unanswered(view.term, steady_now()));
  tell(standby.actions.unanswered(view.term, steady_now()));
}

// For a bridge that has handed over and joins again: a plant system may have discovered it before
// its successor, and sent commands only to it.
void Bridge::State::tell_last_words() {
  const StandbyGroup::View view = group->view();
  if (view.role != StandbyRole::kWaiting || !view.master) return;
  const auto tell = [this](const auto& held) {
    for (const auto& [bus, key, begun] : held) group->tell_held(bus, key.first, key.second, begun);
  };
  tell(standby.commands.last_words(steady_now()));
  tell(standby.actions.last_words(steady_now()));
}

// At the master, on a DDS thread. Repeats a result that the other member missed. Ignores requests
// before this bridge has taken over: the member reports them again.
void Bridge::State::answer_unknown(const StandbyNote& held) {
  if (!standby.commands.runs() || !standby.actions.runs()) return;
  // A requester numbers its commands and its alarm actions together.
  const bool command = commands.answered_elsewhere(held.requester, held.request_id, steady_now());
  const bool action = alarm_actions.answered_elsewhere(held.requester, held.request_id);
  if (!command || !action) {
    if (standby.has_result(held.requester, held.request_id))
      group->tell_answered(held.bus, held.requester, held.request_id);
    return;
  }
  const bool begun = held.kind == StandbyNoteKind::kBegun;
  const CommandResult result =
      unfinished(held.requester, held.request_id, begun, read_clocks().instant);
  if (keep_late(held.bus, result)) return;
  answer_held(held.bus, result);
}

// Handles a response of another bridge, seen as its result or reported by the master.
void Bridge::State::seen_answer(const std::string& requester, std::uint64_t request_id) {
  standby.seen_answer(requester, request_id);
  commands.answered_elsewhere(requester, request_id, steady_now());
}

void Bridge::State::answer_held(const std::string& bus, const CommandResult& result) {
  audit.answered(bus, result);
  standby.note_result(result.requester, result.request_id);
  link->complete(bus, result, read_clocks());
}

// The steps of a command at the bridge that runs it. DdsLink has authenticated the requester. The
// bus executes the command, and BusOutput::complete() responds. `late`: the command has already
// expired; the text is the reason.
void Bridge::State::run_command(const std::string& bus, Command command, std::string late) {
  const Instant now = steady_now();
  if (commands.was_answered_elsewhere(command, now)) return;
  const AuditEntry asked = audit.asked(bus, command);
  ++standby.in_hand;
  std::optional<CommandResult> refused = commands.deduplicate(command, now, std::move(late));
  if (!refused && CommandRouter::must_be_noted(command) && (group || identities))
    return run_noted(bus, command, now);
  if (!refused) refused = commands.route(bus, command, CommandRouter::Identity::kNew, now);
  if (!refused) return;
  audit.refused(asked, *refused);
  if (!keeps_result(bus, *refused)) link->complete(bus, *refused, read_clocks());
}

// Before a write is sent to the bus, notes it at all members that may have to respond for it, and
// in the store.
void Bridge::State::run_noted(const std::string& bus, const Command& command, Instant received) {
  const auto run = [this, bus, command, received](CommandRouter::Identity identity) {
    const auto refused = commands.route(bus, command, identity, received);
    if (!refused || keeps_result(bus, *refused)) return;
    audit.answered(bus, *refused);
    link->complete(bus, *refused, read_clocks());
  };
  const auto keep = [this, run, requester = command.requester, id = command.request_id] {
    identities ? identities->enter(requester, id, run) : run(CommandRouter::Identity::kNew);
  };
  if (!group) return keep();
  group->begin(bus, command.requester, command.request_id, [keep, run](bool noted) {
    noted ? keep() : run(CommandRouter::Identity::kNotNoted);
  });
}

void Bridge::State::run_action(const AlarmAction& action) {
  const UtcMapping now = read_clocks();
  standby.note_result(action.requester, action.request_id);
  link->complete(action.alarm.bus, alarm_actions.take(action, now), now);
}

// Returns true if this bridge must not publish the result: the successor runs the command, or the
// master is not known at this moment.
bool Bridge::State::keeps_result(const std::string& bus, const CommandResult& result) {
  standby.answered();
  if (!spec.standby) return false;
  if (standby.handing_over && result.state == CommandState::kRejected &&
      result.cause == Cause::kShutdown) {
    group->give_back(bus, result.requester, result.request_id);
    return true;
  }
  // Members that cannot receive each other: the one that uses the wire responds.
  if (result.state == CommandState::kRejected && result.cause == Cause::kForeignMaster) return true;
  return keep_late(bus, result);
}

// Keeps the result while the lease is not held, because the master is then unknown.
bool Bridge::State::keep_late(const std::string& bus, const CommandResult& result) {
  if (lease.holds()) {
    standby.note_result(result.requester, result.request_id);
    return false;
  }
  const std::lock_guard lock(standby.late_mutex);
  standby.late.emplace_back(bus, result);
  standby.notify();
  return true;
}

// Publishes the kept results if this bridge is still master.
void Bridge::State::finish_held() {
  if (!standby.serving || !lease.holds()) return;
  std::vector<std::pair<std::string, CommandResult>> late;
  {
    const std::lock_guard lock(standby.late_mutex);
    late.swap(standby.late);
  }
  for (const auto& [bus, result] : late) answer_held(bus, result);
}

}  // namespace fieldcast
