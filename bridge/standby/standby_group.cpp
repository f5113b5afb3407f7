#include "bridge/standby/standby_group.hpp"

#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "bridge/base/check.hpp"
#include "bridge/base/clock.hpp"
#include "bridge/standby/member_identity.hpp"

namespace fieldcast {
namespace {

constexpr std::size_t kMostWaiting = 4096;

// Real-time priority, if permitted, so that a busy machine does not look like a failed one.
void ask_for_priority() {
  sched_param wanted{};
  wanted.sched_priority = 1;
  (void)pthread_setschedparam(pthread_self(), SCHED_RR, &wanted);
}

}  // namespace

StandbyGroup::StandbyGroup(std::string group, const StandbyMember& own, MasterLease& lease,
                           Handlers handlers, const Election::Memory& before)
    : group_(std::move(group)),
      host_(own_host_name()),
      process_(own_process_identity()),
      lease_(lease),
      handlers_(std::move(handlers)),
      wake_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
      election_(own, steady_now(), before),
      own_name_(own.bridge) {
  lease_.set(kLongAgo);
}

StandbyGroup::~StandbyGroup() { end(); }

void StandbyGroup::start() {
  thread_ = std::thread([this] { run(); });
}

void StandbyGroup::end() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    lease_.set(kLongAgo);
  }
  wake();
  thread_.join();
  std::vector<Waiting> waiting;
  StandbyMessage last;
  {
    const std::lock_guard lock(mutex_);
    waiting.swap(waiting_);
    last = message(steady_now());
  }
  for (const Waiting& each : waiting) each.done(false);
  last.member.role = StandbyRole::kLeft;
  last.member.not_ready = "it has ended";
  handlers_.tell(last);
}

Election::Memory StandbyGroup::memory() const {
  const std::lock_guard lock(mutex_);
  return election_.memory();
}

void StandbyGroup::wake() const {
  const std::uint64_t one = 1;
  (void)!::write(wake_.get(), &one, sizeof one);
}

template <class Input>
void StandbyGroup::apply(Input input) {
  {
    const std::lock_guard lock(mutex_);
    input();
    if (!ending_) follow_role();  // end() has released the lease
  }
  wake();
}

void StandbyGroup::on_member(const StandbyMessage& message) {
  apply([&] {
    if (ending_) return;
    election_.receive(message.member, steady_now());
    others_[message.member.bridge] = message;
  });
}

// While this bridge was stopped, another master has begun or responded to a write that waits here
// or that has not arrived yet. The write must not run twice.
void StandbyGroup::give_up_begun(const StandbyNote& note) {
  const RecentCommands::Key key{note.requester, note.request_id};
  std::vector<std::function<void(bool)>> given_up;
  {
    const std::lock_guard lock(mutex_);
    if (note.kind == StandbyNoteKind::kReturned) return begun_elsewhere_.remove(key);
    begun_elsewhere_.note(key, steady_now());
    std::erase_if(waiting_, [&](Waiting& each) {
      if (RecentCommands::Key{each.note.requester, each.note.request_id} != key) return false;
      given_up.push_back(std::move(each.done));
      return true;
    });
  }
  for (const auto& done : given_up) done(false);
}

void StandbyGroup::on_lost(const std::string& bridge) {
  apply([&] { election_.lost(bridge, steady_now()); });
}

void StandbyGroup::on_note(const StandbyNote& note) {
  if (note.bridge == own_name_) return;
  if (note.term == 0) {
    if (role() == StandbyRole::kMaster) handlers_.held(note);
    return;
  }
  handlers_.noted(note);
  give_up_begun(note);
  {
    const std::lock_guard lock(mutex_);
    if (note.term < noted_term_) return;
    if (note.term > noted_term_) noted_ = 0;
    noted_term_ = note.term;
    noted_ = std::max(noted_, note.number);
    beat_soon_ = true;
  }
  wake();
}

void StandbyGroup::set_not_ready(std::string reason) {
  apply([&] {
    election_.set_not_ready(std::move(reason));
    beat_soon_ = true;
  });
}

void StandbyGroup::set_configuration(std::string configuration) {
  apply([&] {
    election_.set_configuration(std::move(configuration));
    beat_soon_ = true;
  });
}

std::optional<std::string> StandbyGroup::hand_over(const std::string& successor) {
  std::optional<std::string> refused;
  apply([&] { refused = election_.hand_over(successor, steady_now()); });
  return refused;
}

void StandbyGroup::released() {
  apply([&] { election_.released(steady_now()); });
}

void StandbyGroup::follows(std::uint64_t sequence) {
  apply([&] { election_.follows(sequence); });
}

// Applies a changed role immediately: only a master may send.
void StandbyGroup::follow_role() {
  lease_.set(election_.serves_until());
  const StandbyRole role = election_.role();
  const StandbyTerm term = election_.term();
  const bool later = role == told_ && role == StandbyRole::kMaster && term != told_term_;
  if (role == told_ && !later) return;
  note_again_ |= later;
  told_term_ = term;
  if (role == StandbyRole::kMaster && told_ == StandbyRole::kWaiting) {
    ++terms_begun_;
    written_ = 0;
    released_.reset();
    for (const auto& [name, told] : others_) {
      if (told.member.role == StandbyRole::kReleased && told.member.successor == own_name_ &&
          election_.is_alive(name, steady_now()))
        released_ = told.buses;
    }
  }
  // A former master releases its buses and rejoins.
  if (role == StandbyRole::kWaiting) election_.set_not_ready("it starts again");
  told_ = role;
  beat_soon_ = true;
  handlers_.changed();
}

StandbyMessage StandbyGroup::message(Instant now) {
  StandbyMessage message;
  message.group = group_;
  message.member = election_.beat();
  message.host = host_;
  message.process = process_;
  message.written = written_;
  const auto master = election_.master(now);
  const auto known = master ? others_.find(*master) : others_.end();
  if (known != others_.end() && known->second.member.term == noted_term_) message.noted = noted_;
  return message;
}

void StandbyGroup::begin(const std::string& bus, const std::string& requester,
                         std::uint64_t request_id, std::function<void(bool)> done) {
  StandbyNote note{group_, own_name_, 0, 0, StandbyNoteKind::kBegun, bus, requester, request_id};
  bool may_run = true;
  {
    const std::lock_guard one(noting_);
    {
      const std::lock_guard lock(mutex_);
      const Instant now = steady_now();
      may_run = !begun_elsewhere_.lately({requester, request_id}, now);
      note.term = election_.term();
      if (may_run) note.number = ++written_;
      // A bridge that was stopped may have missed another master.
      const bool sure = others_.empty() || election_.serves(now);
      if (may_run && !(sure && noted_by_all(note.number, now))) {
        may_run = waiting_.size() < kMostWaiting && !ending_;
        if (may_run) waiting_.push_back({note, now + kNoteLimit, std::exchange(done, {})});
      }
    }
    if (note.number != 0) handlers_.note(note);
  }
  if (done) done(may_run);
}

void StandbyGroup::give_back(const std::string& bus, const std::string& requester,
                             std::uint64_t request_id) {
  const std::lock_guard one(noting_);
  StandbyNote note{group_, own_name_, 0, 0, StandbyNoteKind::kReturned, bus, requester, request_id};
  {
    const std::lock_guard lock(mutex_);
    note.term = election_.term();
    note.number = ++written_;
  }
  handlers_.note(note);
}

void StandbyGroup::tell_held(const std::string& bus, const std::string& requester,
                             std::uint64_t request_id, bool begun) {
  const std::lock_guard one(noting_);
  const auto kind = begun ? StandbyNoteKind::kBegun : StandbyNoteKind::kReturned;
  handlers_.note({group_, own_name_, 0, 0, kind, bus, requester, request_id});
}

void StandbyGroup::tell_completed(const std::string& bus, const std::string& requester,
                                  std::uint64_t request_id) {
  const std::lock_guard one(noting_);
  const auto kind = StandbyNoteKind::kCompleted;
  handlers_.note({group_, own_name_, term(), 0, kind, bus, requester, request_id});
}

// Pending writes, in the term that has just begun, because the others count notes per term.
std::vector<StandbyNote> StandbyGroup::notes_again() {
  std::vector<StandbyNote> notes;
  if (!std::exchange(note_again_, false)) return notes;
  for (Waiting& each : waiting_) {
    each.note.term = election_.term();
    notes.push_back(each.note);
  }
  return notes;
}

// Returns true if all members that could take over have the note.
bool StandbyGroup::noted_by_all(std::uint64_t number, Instant now) const {
  return std::ranges::all_of(others_, [&](const auto& entry) {
    const auto& [name, told] = entry;
    if (!election_.is_alive(name, now) || !told.member.not_ready.empty()) return true;
    return told.member.term == election_.term() && told.noted >= number;
  });
}

std::vector<std::pair<std::function<void(bool)>, bool>> StandbyGroup::settle_notes(Instant now) {
  std::vector<std::pair<std::function<void(bool)>, bool>> done;
  std::erase_if(waiting_, [&](Waiting& each) {
    const bool serves = election_.serves(now);
    const bool noted = serves && noted_by_all(each.note.number, now);
    if (!noted && serves && now < each.until) return false;
    done.emplace_back(std::move(each.done), noted);
    return true;
  });
  return done;
}

// The end of a member's process on the same kernel is detected immediately.
void StandbyGroup::watch_processes() {
  for (const auto& [name, told] : others_) {
    Process& process = processes_[name];
    if (process.identity == told.process) continue;
    process.identity = told.process;
    process.handle = open_process(told.process);
  }
}

void StandbyGroup::look_at_processes() {
  for (auto& [name, process] : processes_) {
    if (!process.handle.valid()) continue;
    pollfd ended{process.handle.get(), POLLIN, 0};
    if (::poll(&ended, 1, 0) <= 0) continue;
    process.handle.reset();
    election_.lost(name, steady_now());
  }
}

void StandbyGroup::run() {
  pthread_setname_np(pthread_self(), "standby");
  ask_for_priority();
  Instant next_beat = steady_now();
  for (;;) {
    std::vector<pollfd> sources{{wake_.get(), POLLIN, 0}};
    std::vector<std::pair<std::function<void(bool)>, bool>> noted;
    std::optional<StandbyMessage> told;
    std::vector<StandbyNote> again;
    {
      const std::lock_guard lock(mutex_);
      if (ending_) return;
      const Instant now = steady_now();
      watch_processes();
      look_at_processes();
      if (handlers_.readers_came()) election_.readers_came(now);
      election_.on_time(now);
      follow_role();
      noted = settle_notes(now);
      again = notes_again();
      if (now >= next_beat || std::exchange(beat_soon_, false)) {
        told = message(now);
        next_beat = now + Election::kBeat;
      }
      for (const auto& [name, process] : processes_) {
        if (process.handle.valid()) sources.push_back({process.handle.get(), POLLIN, 0});
      }
    }
    for (const auto& [done, all] : noted) done(all);
    for (const StandbyNote& note : again) handlers_.note(note);
    if (told) {
      told->buses = handlers_.figures();
      handlers_.tell(*told);
    }
    const auto tick = std::chrono::duration_cast<std::chrono::milliseconds>(Election::kTick);
    (void)::poll(sources.data(), sources.size(), static_cast<int>(tick.count()));
    std::uint64_t woken = 0;
    (void)!::read(wake_.get(), &woken, sizeof woken);
  }
}

std::optional<std::vector<StandbyBusFigures>> StandbyGroup::released_by_other() const {
  const std::lock_guard lock(mutex_);
  return released_;
}

StandbyRole StandbyGroup::role() const {
  const std::lock_guard lock(mutex_);
  return election_.role();
}

StandbyTerm StandbyGroup::term() const {
  const std::lock_guard lock(mutex_);
  return election_.term();
}

StandbyGroup::View StandbyGroup::view() const {
  const std::vector<StandbyBusFigures> own = handlers_.figures();
  const std::lock_guard lock(mutex_);
  const Instant now = steady_now();
  View view;
  view.role = election_.role();
  view.term = election_.term();
  view.master = election_.master(now);
  view.not_ready = election_.not_ready(now);
  view.terms_begun = terms_begun_;
  for (const auto& [name, told] : others_) {
    if (!election_.is_alive(name, now)) continue;
    view.others.push_back(name);
    if (view.master != name) continue;
    view.term = told.member.term;
    for (const StandbyBusFigures& theirs : told.buses) {
      const auto mine = std::ranges::find(own, theirs.bus, &StandbyBusFigures::bus);
      if (mine != own.end() && mine->epoch == theirs.epoch && mine->blocks < theirs.blocks)
        view.behind += theirs.blocks - mine->blocks;
    }
  }
  return view;
}

}  // namespace fieldcast
