// A bridge of a standby group: how it prepares, takes over and releases its buses.
#include <fmt/format.h>

#include "bridge/base/clock.hpp"
#include "bridge/bridge_state.hpp"
#include "bridge/standby/member_identity.hpp"

namespace fieldcast {
namespace {

// Limit for a master that hands over, to wait for running commands.
constexpr Duration kFinish = std::chrono::seconds{1};
// Samples of a released master arrive within this time or are counted as lost.
constexpr Duration kLastBlocks = std::chrono::milliseconds{50};
// Delay after the handover, so that the successor has written everything before this one leaves.
constexpr Duration kAfterHandOver = std::chrono::milliseconds{500};
// Exceeds the samples of a master after its successor last received from it. The gap of the term
// (sequences_of) is larger, except with an earlier version or more than 2^32 samples.
constexpr std::uint64_t kSequenceMargin = 1024;

std::uint64_t greatest_sequence(const std::map<std::string, FollowedBus>& known) {
  std::uint64_t greatest = 0;
  for (const auto& [name, bus] : known) {
    for (const Sample& sample : bus.state.samples) greatest = std::max(greatest, sample.sequence);
  }
  return greatest;
}

}  // namespace

// Throws DdsError.
void Bridge::State::join_group() {
  const StandbySpec& wanted = *spec.standby;
  guard->join_group(wanted.group, wanted.strength);
  link->stand_by(true);
  standby.commands.join();
  standby.actions.join();
  standby.serving = false;
  standby.handing_over = false;
  standby.in_hand = 0;
  StandbyMember own;
  own.bridge = spec.name;
  own.since = read_clocks().utc.nanoseconds;
  own.strength = wanted.strength;
  own.configuration = common_configuration(spec);
  StandbyGroup::Handlers handlers;
  handlers.tell = [this](const StandbyMessage& message) { channel->tell(message); };
  handlers.note = [this](const StandbyNote& note) { channel->tell(note); };
  handlers.figures = [this] {
    const std::lock_guard lock(standby.follower_mutex);
    return follower ? follower->figures() : link->stream_figures();
  };
  handlers.readers_came = [this] { return standby.readers_came.exchange(false); };
  handlers.changed = [this] { standby.notify(); };
  handlers.noted = [this](const StandbyNote& note) {
    if (note.kind == StandbyNoteKind::kAnswered)
      return seen_answer(note.requester, note.request_id);
    const HeldCommands<Standby::HeldCommand>::Key key{note.requester, note.request_id};
    if (note.kind == StandbyNoteKind::kReturned) {
      standby.commands.returned(key);
      return standby.notify();
    }
    standby.commands.begun(note.bus, key, steady_now() + std::chrono::minutes{1});
  };
  handlers.held = [this](const StandbyNote& note) { answer_unknown(note); };
  if (standby.remembered_group != wanted.group) standby.remembered = {};
  standby.remembered_group = wanted.group;
  group = std::make_unique<StandbyGroup>(wanted.group, own, lease, std::move(handlers),
                                         standby.remembered);
  StandbyChannelHandlers heard;
  heard.member = [this](const StandbyMessage& message) { group->on_member(message); };
  heard.lost = [this](const std::string& bridge) { group->on_lost(bridge); };
  heard.note = [this](const StandbyNote& note) { group->on_note(note); };
  heard.request = [this](const StandbyRequest& request) { on_request(request); };
  channel = std::make_unique<StandbyChannel>(link->domain(), "fieldcast-bridge " + spec.name,
                                             wanted.group, UtcTime{own.since}, std::move(heard));
  follower = std::make_unique<StandbyFollower>(
      link->domain(), spec.buses,
      FollowerHandlers{[this](const std::string& requester, std::uint64_t request_id) {
        seen_answer(requester, request_id);
      }});
  group->start();
}

void Bridge::State::stand_alone() {
  lease.set(kNever);
  (void)standby.commands.take_over(steady_now());
  (void)standby.actions.take_over(steady_now());
}

void Bridge::State::on_request(const StandbyRequest& request) {
  if (group->role() != StandbyRole::kMaster) return;
  const auto refused = group->hand_over(request.bridge);
  const std::string who = request.by.empty() ? "somebody" : request.by;
  if (refused)
    return log_warning(spec.name, fmt::format("not handed over, as {} wants: {}", who, *refused));
  log_info(spec.name, fmt::format("handed over, as {} wants", who));
}

// Does every slow step before this bridge becomes master.
void Bridge::State::prepare_bus(const BusSpec& bus) {
  standby.prepared.emplace(bus.name, make_bus(bus));
  link->prepare_bus(bus);
}

// To be called at the start, if the wait is longer than usual.
void Bridge::State::say_waits_for(const std::string& what) {
  const Duration most = spec.standby ? Settling::kMostInGroup : Settling::kMost;
  log_info(spec.name, fmt::format("serves nothing yet, and waits for {}; at most {} in all", what,
                                  to_text(most)));
  if (group) group->set_not_ready("it waits for " + what);
}

void Bridge::State::say_unheard(std::size_t bridges) {
  log_warning(spec.name,
              fmt::format("{} bridges are in DDS domain {} and say nothing that this one can read: "
                          "they may have died a moment ago, or dds: security: is not the same "
                          "there and here",
                          bridges, spec.dds.domain));
}

void Bridge::State::take_part() {
  standby.shadowed = "it has not looked";
  look_for_namesake();  // reports that it is ready
  log_info(spec.name, fmt::format("stands by in group {}, with strength {}", spec.standby->group,
                                  spec.standby->strength));
  standby.start([this] { return follow_role(); });
  standby.notify();
}

void Bridge::State::leave_group() {
  if (!group) return;
  tell_last_words();
  group->end();
  standby.remembered = group->memory();
  end_follower();
}

// Outside the lock: the group's thread takes it, and the destructor waits for library threads.
void Bridge::State::end_follower() {
  std::unique_ptr<StandbyFollower> ended;
  {
    const std::lock_guard lock(standby.follower_mutex);
    ended.swap(follower);
  }
}

// Runs on the main thread, before the stop. Returns true if another bridge of the group serves the
// buses; their instances must then not be disposed.
bool Bridge::State::hand_over_before_stop() {
  standby.leaving = true;
  standby.notify();
  {
    const std::lock_guard lock(changing);
    if (!group || !standby.serving) return group != nullptr;
  }
  if (const auto refused = group->hand_over({})) {
    log_info(spec.name, fmt::format("no other bridge takes over: {}", *refused));
    return false;
  }
  const bool replaced = standby.wait_until(steady_now() + kFinish + Election::kHandOver, [this] {
    const StandbyGroup::View view = group->view();
    return view.role == StandbyRole::kWaiting && view.master.has_value();
  });
  if (replaced) standby.linger(kAfterHandOver);
  return replaced;
}

// Runs on the thread of roles. Returns true if it must be called again soon.
bool Bridge::State::follow_role() {
  const std::unique_lock lock(changing, std::try_to_lock);
  if (!lock) return true;  // the main thread stops or reloads
  if (standby.leaving && !standby.serving) return false;
  if (!link) {  // the last restart failed
    start_as_standby();
    return false;
  }
  if (!group) return false;
  const StandbyRole role = group->role();
  if (role == StandbyRole::kMaster && !standby.serving && !standby.handing_over) {
    promote();
  } else if (role == StandbyRole::kHandingOver && standby.serving) {
    release();
  } else if (role == StandbyRole::kWaiting && standby.serving) {
    step_back();
  } else if (standby.handing_over && role != StandbyRole::kReleased && !standby.leaving) {
    start_as_standby();
  } else if (role == StandbyRole::kMaster && standby.serving && group->term() != standby.term) {
    remain_master();
  }
  if (!standby.handing_over) look_for_namesake();
  say_not_ready();
  finish_held();
  tell_held();
  return standby.handing_over || !late_results_done();
}

// Detects a copied configuration: of two members with one name, the second one serves no bus.
void Bridge::State::look_for_namesake() {
  const auto found = guard->namesake();
  const auto host = [&] { return found->claims.host; };
  std::string shadowed;
  if (found && found->goes_first && !standby.serving)
    shadowed = fmt::format(
        "another bridge of group {} is called {}, on host {}: give this one a "
        "name of its own (bridge: {{ name: .. }})",
        spec.standby->group, spec.name, host());
  if (shadowed != standby.shadowed) {
    group->set_not_ready(shadowed);
    standby.shadowed = std::move(shadowed);
  }
  const bool besides = found && standby.shadowed.empty();
  if (besides && !standby.has_namesake)
    log_error(spec.name, fmt::format("another bridge of group {} has this name, on host {}: give "
                                     "it a name of its own (bridge: {{ name: .. }})",
                                     spec.standby->group, host()));
  standby.has_namesake = besides;
}

// Reports as soon as this bridge cannot take over, not only when a takeover is needed.
void Bridge::State::say_not_ready() {
  if (!group || standby.serving || standby.handing_over) return;
  std::string why = group->view().not_ready;
  if (why == standby.said_not_ready) return;
  if (!why.empty())
    log_warning(spec.name,
                fmt::format("does not take over in group {}: {}", spec.standby->group, why));
  standby.said_not_ready = std::move(why);
}

bool Bridge::State::late_results_done() {
  const std::lock_guard lock(standby.late_mutex);
  return standby.late.empty();
}

void Bridge::State::promote() {
  const Instant begun = steady_now();
  const auto released = group->released_by_other();
  const bool whole = released && follower->wait_for(*released, kLastBlocks);
  const UtcMapping now = read_clocks();
  auto known = follower->take(now);
  group->follows(greatest_sequence(known));
  guard->stand_by(false);
  link->stand_by(false);
  standby.serving = true;
  standby.term = group->term();
  std::vector<std::string> taken;
  for (const BusSpec& bus : spec.buses) {
    FollowedBus& followed = known[bus.name];
    const bool goes_on = followed.epoch != 0;
    if (!guard->serves(bus.name)) {
      start_buses({bus.name}, spec);  // logs the reason
      continue;
    }
    try {
      start_bus(bus, goes_on ? &followed : nullptr, whole ? 0 : kSequenceMargin);
      if (goes_on) taken.push_back(bus.name);
    } catch (const DdsError& error) { log_error(bus.name, error.what()); }
  }
  const Duration running = steady_now() - begun;
  for (const std::string& bus : taken) link->publish_again(bus);
  const std::vector<StationAlarmStatus> alarms_of_master = follower->alarms();
  run_held();
  if (taken.empty()) {
    log_info(spec.name, fmt::format("is master of group {}", spec.standby->group));
  } else {
    log_warning(spec.name,
                fmt::format("has taken over in group {} ({}), term {}: buses run after {}",
                            spec.standby->group,
                            released ? "the master has handed over" : "the master has left",
                            number_of(standby.term), to_text(running)));
  }
  take_over_followed_alarms(taken, alarms_of_master);
  finish_begun();
  end_follower();
}

// Another bridge may have been master meanwhile, with greater sequence numbers.
void Bridge::State::remain_master() {
  standby.term = group->term();
  for (const auto& [name, bus] : buses) {
    bus.runner->count_above(sequences_of(standby.term));
    alarms.publish_again(name);
  }
  log_warning(
      spec.name,
      fmt::format("remains master of group {}, term {}: another member may have been master "
                  "meanwhile; its samples count above those of that one",
                  spec.standby->group, number_of(standby.term)));
}

// A shared store has more than the published data; a file on this host has less.
void Bridge::State::take_over_followed_alarms(const std::vector<std::string>& taken,
                                              const std::vector<StationAlarmStatus>& followed) {
  const bool common = spec.store && spec.store->address.starts_with("postgres");
  for (const std::string& bus : taken) {
    if (common) {
      take_over_alarms(bus);
      continue;
    }
    KeptAlarms kept;
    for (const StationAlarmStatus& each : followed) {
      if (each.alarm.bus != bus) continue;
      kept.states.push_back({each.alarm, each.status});
      if (each.status.active) kept.active.push_back({each.alarm, each.status});
    }
    alarms.followed(bus, kept);
  }
}

// In order: running commands end, then the buses are released.
void Bridge::State::release() {
  standby.handing_over = true;
  standby.commands.stand_by();  // new commands belong to the successor
  standby.actions.stand_by();
  (void)standby.wait_until(steady_now() + kFinish, [this] { return standby.in_hand == 0; });
  std::vector<std::string> names;
  for (const auto& [name, bus] : buses) names.push_back(name);
  stop_runners(names);
  standby.serving = false;
  group->released();
  log_info(spec.name, "has released its buses to another bridge of the group");
}

// Another bridge is master, with a later term.
void Bridge::State::step_back() {
  log_warning(spec.name,
              fmt::format("steps back: {} is master of group {}",
                          group->view().master.value_or("another bridge"), spec.standby->group));
  if (!standby.leaving) return start_as_standby();
  std::vector<std::string> names;
  for (const auto& [name, bus] : buses) names.push_back(name);
  stop_runners(names);
  standby.serving = false;
}

// Restarts everything without disposing the instances that another bridge now serves.
void Bridge::State::start_as_standby() {
  const BridgeSpec same = spec;
  standby.serving = false;
  if (link && standby.handing_over) standby.linger(kAfterHandOver);
  stop_all(program::Server::Modules::kKeep, DdsLink::Leave::kHandOver);
  {
    const std::lock_guard lock(standby.late_mutex);
    standby.late.clear();
  }
  standby.handing_over = false;
  if (const auto started =
          start(same, program::Server::Modules::kKeep, [this] { return standby.leaving.load(); });
      !started) {
    log_error(same.name, "cannot stand by: " + started.error());
  }
}

StandbyFigures Bridge::State::standby_figures() const {
  const StandbyGroup::View view = group->view();
  StandbyFigures told;
  told.master = view.role == StandbyRole::kMaster || view.role == StandbyRole::kHandingOver;
  told.ready = told.master || view.not_ready.empty();
  told.term = number_of(view.term);
  told.takeovers = view.terms_begun;
  told.behind = view.behind;
  return told;
}

}  // namespace fieldcast
