#include "bridge/role/membership.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bridge/base/clock.hpp"
#include "bridge/dds/endpoints/standby_channel.hpp"
#include "bridge/dds/receivers/standby_follower.hpp"
#include "bridge/log/log.hpp"
#include "bridge/standby/member_identity.hpp"

namespace fieldcast {
namespace {

// Limit for a master that hands over, to wait for running commands.
constexpr Duration kFinish = std::chrono::seconds{1};
// Samples of a released master arrive within this time or are counted as lost.
constexpr Duration kLastBlocks = std::chrono::milliseconds{50};
// Exceeds the samples of a master after its successor last received from it; needed only with an
// earlier version or more than 2^32 samples, as the gap of the term (sequences_of) is larger.
constexpr std::uint64_t kSequenceMargin = 1024;

std::uint64_t greatest_sequence(const std::map<std::string, FollowedBus>& known) {
  std::uint64_t greatest = 0;
  for (const auto& [name, bus] : known) {
    for (const Sample& sample : bus.state.samples) greatest = std::max(greatest, sample.sequence);
  }
  return greatest;
}

StandbyMember member_of(const BridgeSpec& spec) {
  StandbyMember own;
  own.bridge = spec.name;
  own.since = read_clocks().utc.nanoseconds;
  own.strength = spec.standby->strength;
  own.configuration = common_configuration(spec);
  return own;
}

}  // namespace

Membership::Membership(const Uses& uses, const BridgeSpec& spec, const Memory& before)
    : uses_(uses),
      name_(spec.name),
      strength_(spec.standby->strength),
      has_common_store_(spec.store && spec.store->address.starts_with("postgres")) {
  if (before.group == spec.standby->group) memory_ = before;
  memory_.group = spec.standby->group;
  uses_.guard.join_group(memory_.group, strength_);
  uses_.link.stand_by(true);
  const StandbyMember own = member_of(spec);
  group_ = std::make_unique<StandbyGroup>(memory_.group, own, uses_.lease, group_handlers(),
                                          memory_.election);
  uses_.commands.join(*group_);
  StandbyChannelHandlers heard;
  heard.member = [this](const StandbyMessage& message) { group_->on_member(message); };
  heard.lost = [this](const std::string& bridge) { group_->on_lost(bridge); };
  heard.note = [this](const StandbyNote& note) { group_->on_note(note); };
  heard.request = [this](const StandbyRequest& request) { on_request(request); };
  channel_ = std::make_unique<StandbyChannel>(uses_.link.domain(), "fieldcast-bridge " + name_,
                                              memory_.group, UtcTime{own.since}, std::move(heard));
  follower_ = std::make_unique<StandbyFollower>(
      uses_.link.domain(), spec.buses,
      FollowerHandlers{[this](const std::string& requester, std::uint64_t request_id) {
        uses_.commands.seen_result(requester, request_id);
      }});
  group_->start();
}

Membership::~Membership() = default;

StandbyGroup::Handlers Membership::group_handlers() {
  StandbyGroup::Handlers handlers;
  handlers.tell = [this](const StandbyMessage& message) { channel_->tell(message); };
  handlers.note = [this](const StandbyNote& note) { channel_->tell(note); };
  handlers.figures = [this] {
    const std::lock_guard lock(follower_mutex_);
    return follower_ ? follower_->figures() : uses_.link.stream_figures();
  };
  handlers.readers_came = [this] { return uses_.readers_came.exchange(false); };
  handlers.changed = [this] { uses_.roles.notify(); };
  handlers.noted = [this](const StandbyNote& note) { uses_.commands.note(note); };
  handlers.held = [this](const StandbyNote& note) { uses_.commands.resolve_unknown(note); };
  return handlers;
}

void Membership::on_request(const StandbyRequest& request) {
  if (group_->role() != StandbyRole::kMaster) return;
  const auto refused = group_->hand_over(request.bridge);
  const std::string who = request.by.empty() ? "somebody" : request.by;
  if (refused)
    return log_warning(name_, fmt::format("not handed over, as {} wants: {}", who, *refused));
  log_info(name_, fmt::format("handed over, as {} wants", who));
}

void Membership::take_part() {
  look_for_namesake();  // reports that it is ready
  log_info(name_, fmt::format("stands by in group {}, with strength {}", memory_.group, strength_));
}

void Membership::reconfigure(const BridgeSpec& spec) {
  group_->set_configuration(common_configuration(spec));
}

Membership::Memory Membership::leave() {
  uses_.commands.report_held(true);
  group_->end();
  memory_.election = group_->memory();
  end_follower();
  return memory_;
}

// Outside the lock: the group's thread takes it, and the destructor waits for library threads.
void Membership::end_follower() {
  std::unique_ptr<StandbyFollower> ended;
  {
    const std::lock_guard lock(follower_mutex_);
    ended.swap(follower_);
  }
}

std::optional<std::string> Membership::hand_over() {
  auto refused = group_->hand_over({});
  const bool gives_way = group_->role() != StandbyRole::kMaster;
  return gives_way ? std::nullopt : std::move(refused);
}

bool Membership::hand_over_before_stop() {
  if (const auto refused = hand_over()) {
    log_info(name_, fmt::format("no other bridge takes over: {}", *refused));
    return false;
  }
  const bool replaced =
      uses_.roles.wait_until(steady_now() + kFinish + Election::kHandOver, [this] {
        const StandbyGroup::View view = group_->view();
        return view.role == StandbyRole::kWaiting && view.master.has_value();
      });
  const Instant now = steady_now();
  if (replaced) pause_.begin(now);
  (void)uses_.roles.wait_until(now + pause_.left(now), [] { return false; });
  return replaced;
}

Membership::Next Membership::follow_role(bool leaving) {
  const StandbyRole role = group_->role();
  CommandService& commands = uses_.commands;
  const bool handing_over = commands.is_handing_over();
  // The election may end the mastership before promote() was called.
  const auto was_master = [this] { return group_->view().terms_begun > 0; };
  if (role == StandbyRole::kMaster && !serves_ && !handing_over) {
    promote();
  } else if (role == StandbyRole::kHandingOver && !handing_over) {
    release();
  } else if (role == StandbyRole::kWaiting && !handing_over && was_master()) {
    log_warning(name_,
                fmt::format("steps back: {} is master of group {}",
                            group_->view().master.value_or("another bridge"), memory_.group));
    if (!leaving) return Next::kRestart;
    uses_.buses.stop_runners();
    serves_.reset();
  } else if (handing_over && role != StandbyRole::kReleased && !leaving) {
    const Instant now = steady_now();
    pause_.begin(now);
    return pause_.left(now) > Duration::zero() ? Next::kSoon : Next::kRestart;
  } else if (role == StandbyRole::kMaster && serves_ && group_->term() != *serves_) {
    remain_master();
  }
  if (!commands.is_handing_over()) look_for_namesake();
  report_not_ready();
  if (serves_) commands.finish_late();
  commands.report_held(false);
  return commands.is_handing_over() || commands.has_late() ? Next::kSoon : Next::kWait;
}

// Detects a copied configuration: of two members with one name, the second one serves no bus.
void Membership::look_for_namesake() {
  const auto found = uses_.guard.namesake();
  const auto host = [&] { return found->claims.host; };
  std::string shadowed;
  if (found && found->goes_first && !serves_)
    shadowed = fmt::format(
        "another bridge of group {} is called {}, on host {}: give this one a "
        "name of its own (bridge: {{ name: .. }})",
        memory_.group, name_, host());
  if (shadowed != shadowed_) {
    group_->set_not_ready(shadowed);
    shadowed_ = std::move(shadowed);
  }
  const bool besides = found && shadowed_.empty();
  if (besides && !memory_.has_namesake)
    log_error(name_, fmt::format("another bridge of group {} has this name, on host {}: give "
                                 "it a name of its own (bridge: {{ name: .. }})",
                                 memory_.group, host()));
  memory_.has_namesake = besides;
}

// Reports as soon as this bridge cannot take over, not only when a takeover is needed.
void Membership::report_not_ready() {
  if (serves_ || uses_.commands.is_handing_over()) return;
  std::string why = group_->view().not_ready;
  if (why == memory_.not_ready) return;
  if (!why.empty())
    log_warning(name_, fmt::format("does not take over in group {}: {}", memory_.group, why));
  memory_.not_ready = std::move(why);
}

void Membership::promote() {
  const Instant begun = steady_now();
  const auto released = group_->released_by_other();
  const bool whole = released && follower_->wait_for(*released, kLastBlocks);
  auto known = follower_->take(read_clocks());
  group_->follows(greatest_sequence(known));
  uses_.guard.stand_by(false);
  uses_.link.stand_by(false);
  serves_ = group_->term();
  uses_.buses.count_above(*serves_);
  std::vector<std::string> taken;
  for (const BusSpec& bus : uses_.buses.wanted()) {
    FollowedBus& followed = known[bus.name];
    const bool goes_on = followed.epoch != 0;
    try {
      const bool started =
          uses_.buses.start(bus, goes_on ? &followed : nullptr, whole ? 0 : kSequenceMargin);
      if (started && goes_on) taken.push_back(bus.name);
    } catch (const DdsError& error) { log_error(bus.name, error.what()); }
  }
  const Duration running = steady_now() - begun;
  for (const std::string& bus : taken) uses_.link.publish_again(bus);
  const std::vector<StationAlarmStatus> alarms_of_master = follower_->alarms();
  uses_.commands.run_held();
  if (taken.empty()) {
    log_info(name_, fmt::format("is master of group {}", memory_.group));
  } else {
    log_warning(name_, fmt::format("has taken over in group {} ({}), term {}: buses run after {}",
                                   memory_.group,
                                   released ? "the master has handed over" : "the master has left",
                                   number_of(*serves_), to_text(running)));
  }
  take_over_alarms(taken, alarms_of_master);
  uses_.commands.finish_begun();
  end_follower();
}

// A shared store has more than the published data; a file on this host has less.
void Membership::take_over_alarms(const std::vector<std::string>& taken,
                                  const std::vector<StationAlarmStatus>& followed) {
  if (has_common_store_) return uses_.buses.load_alarms(taken);
  for (const std::string& bus : taken) {
    KeptAlarms kept;
    for (const StationAlarmStatus& each : followed) {
      if (each.alarm.bus != bus) continue;
      kept.states.push_back({each.alarm, each.status});
      if (each.status.active) kept.active.push_back({each.alarm, each.status});
    }
    uses_.alarms.followed(bus, kept);
  }
}

// Another bridge may have been master meanwhile, with greater sequence numbers.
void Membership::remain_master() {
  serves_ = group_->term();
  uses_.buses.count_above(*serves_);
  log_warning(
      name_, fmt::format("remains master of group {}, term {}: another member may have been master "
                         "meanwhile; its samples count above those of that one",
                         memory_.group, number_of(*serves_)));
}

// In order: running commands end, then the buses are released.
void Membership::release() {
  uses_.commands.hand_over(kFinish);
  uses_.buses.stop_runners();
  serves_.reset();
  group_->released();
  log_info(name_, "has released its buses to another bridge of the group");
}

StandbyFigures Membership::figures() const {
  const StandbyGroup::View view = group_->view();
  StandbyFigures figures;
  figures.master = view.role == StandbyRole::kMaster || view.role == StandbyRole::kHandingOver;
  figures.ready = figures.master || view.not_ready.empty();
  figures.term = number_of(view.term);
  figures.takeovers = view.terms_begun;
  figures.behind = view.behind;
  return figures;
}

}  // namespace fieldcast
