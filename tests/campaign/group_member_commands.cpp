// How a GroupMember runs commands and notifies the other members before a write begins.
#include <algorithm>

#include "core/model/command.hpp"
#include "tests/campaign/group_member.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

constexpr Duration kNoteLimit = 1s;  // as StandbyGroup::kNoteLimit
constexpr Duration kLook = 1s;       // interval of the role thread

}  // namespace

void GroupMember::run_held(Instant now) {
  for (Command& command : held_->take_over(now)) run(std::move(command), now);
  if (held_->waits()) give_up_at_ = now + HeldCommands<Command>::kLastWords;
}

// Finishes the commands that the previous master had begun.
void GroupMember::finish_begun(Instant now) {
  if (give_up_at_ == kNever || (held_->waits() && now < give_up_at_)) return;
  give_up_at_ = kNever;
  auto left = held_->give_up();
  for (Command& command : left.to_run) run(std::move(command), now);
  for (const auto& [bus, key] : left.begun) {
    completed_elsewhere(key, now);
    answer(unfinished(key, true), now);
  }
}

CommandResult GroupMember::unfinished(const Key& key, bool begun) {
  CommandResult result;
  std::tie(result.requester, result.request_id) = key;
  result.state = begun ? CommandState::kFailed : CommandState::kRejected;
  result.cause = Cause::kShutdown;
  result.reason = begun ? "the bridge that had begun it has left" : "it did not reach the master";
  return result;
}

void GroupMember::answer(const CommandResult& result, Instant now) {
  if (!may_send(now)) return late_.push_back(result);
  with_result_.note({result.requester, result.request_id}, now);
  outside_.tell(result);
}

// Mirrors CommandRouter::completed_elsewhere().
bool GroupMember::completed_elsewhere(const Key& key, Instant now) {
  const bool is_new = ledger_->enter(key.first, key.second);
  if (is_new) elsewhere_.note(key, now);
  return is_new;
}

// Mirrors CommandService::seen_result().
void GroupMember::seen_result(const Key& key, Instant now) {
  held_->completed(key);
  completed_elsewhere(key, now);
  with_result_.note(key, now);
}

void GroupMember::run(Command command, Instant now) {
  if (elsewhere_.lately({command.requester, command.request_id}, now)) return;
  ++in_hand_;
  if (!ledger_->enter(command.requester, command.request_id))
    return refuse(command, Cause::kDuplicate, now);
  if (command.operation == Operation::kWrite) return begin(std::move(command), now);
  outside_.wire.feed(index_, CommandArrived{std::move(command)});
}

void GroupMember::refuse(const Command& command, Cause cause, Instant now) {
  complete(rejection(command, cause, "refused by the bridge", now), now);
}

void GroupMember::tell_note(StandbyNoteKind kind, const Key& key, std::uint64_t number) {
  StandbyNote note;
  note.bridge = name_;
  note.term = election_->term();
  note.number = number;
  note.kind = kind;
  note.bus = spec_.name;
  note.requester = key.first;
  note.request_id = key.second;
  outside_.tell(note);
}

// A write runs only after all possible successors have noted that it begins.
void GroupMember::begin(Command command, Instant now) {
  const Key key{command.requester, command.request_id};
  if (begun_elsewhere_.lately(key, now)) return refuse(command, Cause::kOffline, now);
  waiting_.push_back({++written_, now + kNoteLimit, std::move(command)});
  tell_note(StandbyNoteKind::kBegun, key, written_);
  settle_notes(now);
}

// Mirrors CommandService::report_held() and resolve_unknown().
void GroupMember::tell_held(Instant now) {
  next_look_ = now + kLook;
  const auto master = election_->master(now);
  const auto known = master ? others_.find(*master) : others_.end();
  if (election_->role() != StandbyRole::kWaiting || known == others_.end()) return;
  for (const auto& [bus, key, begun] : held_->without_result(known->second.member.term, now)) {
    StandbyNote note;
    note.bridge = name_;
    note.kind = begun ? StandbyNoteKind::kBegun : StandbyNoteKind::kReturned;
    note.bus = bus;
    std::tie(note.requester, note.request_id) = key;
    outside_.tell(note);
  }
}

// Mirrors CommandService::report_held().
void GroupMember::tell_last_words(Instant now) {
  if (election_->role() != StandbyRole::kWaiting || !election_->master(now)) return;
  for (const auto& [bus, key, begun] : held_->last_words(now)) {
    StandbyNote note;
    note.bridge = name_;
    note.kind = StandbyNoteKind::kReturned;
    note.bus = bus;
    std::tie(note.requester, note.request_id) = key;
    outside_.tell(note);
  }
}

void GroupMember::resolve_unknown(const StandbyNote& held, Instant now) {
  if (election_->role() != StandbyRole::kMaster || !held_->runs()) return;
  const Key key{held.requester, held.request_id};
  if (!completed_elsewhere(key, now)) {
    if (with_result_.lately(key, now)) tell_note(StandbyNoteKind::kCompleted, key, 0);
    return;
  }
  answer(unfinished(key, held.kind == StandbyNoteKind::kBegun), now);
}

// Mirrors StandbyGroup::give_up_begun().
void GroupMember::give_up_begun(const StandbyNote& note, Instant now) {
  const Key key{note.requester, note.request_id};
  if (note.kind == StandbyNoteKind::kReturned) return begun_elsewhere_.remove(key);
  begun_elsewhere_.note(key, now);
  std::vector<Command> given_up;
  std::erase_if(waiting_, [&](Waiting& each) {
    if (Key{each.command.requester, each.command.request_id} != key) return false;
    given_up.push_back(std::move(each.command));
    return true;
  });
  for (const Command& command : given_up) refuse(command, Cause::kOffline, now);
}

bool GroupMember::noted_by_all(std::uint64_t number, Instant now) const {
  return std::ranges::all_of(others_, [&](const auto& entry) {
    const auto& [name, told] = entry;
    if (!election_->is_alive(name, now) || !told.member.not_ready.empty()) return true;
    return told.member.term == election_->term() && told.noted >= number;
  });
}

void GroupMember::settle_notes(Instant now) {
  std::vector<std::pair<Command, bool>> done;
  std::erase_if(waiting_, [&](Waiting& each) {
    const bool serves = election_->serves(now);
    const bool noted = serves && noted_by_all(each.number, now);
    if (!noted && serves && now < each.until) return false;
    done.emplace_back(std::move(each.command), noted);
    return true;
  });
  for (auto& [command, noted] : done) {
    if (!noted) {
      refuse(command, Cause::kOffline, now);
    } else if (!serving_) {
      refuse(command, Cause::kShutdown, now);
    } else {
      outside_.wire.feed(index_, CommandArrived{std::move(command)});
    }
  }
}

void GroupMember::complete(const CommandResult& result, Instant now) {
  if (in_hand_ > 0) --in_hand_;
  const bool rejected = result.state == CommandState::kRejected;
  if (handing_over_ && rejected && result.cause == Cause::kShutdown)
    return tell_note(StandbyNoteKind::kReturned, {result.requester, result.request_id}, ++written_);
  if (rejected && result.cause == Cause::kForeignMaster) return;
  answer(result, now);
}

}  // namespace fieldcast::test
