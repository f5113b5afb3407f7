#include "tests/campaign/group_member.hpp"

#include <algorithm>

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

// Same values as in bridge/role/membership.cpp and bridge/buses/bus_set.cpp.
constexpr Duration kFinish = 1s, kLastBlocks = 50ms, kAfterHandOver = 500ms, kProve = 3s;
constexpr std::uint64_t kSequenceMargin = 1024;

std::string name_of_member(std::size_t index) {
  return std::string(1, static_cast<char>('a' + index));
}

}  // namespace

GroupMember::GroupMember(std::size_t index, std::int32_t strength, const BusSpec& spec,
                         Outside outside, std::uint64_t seed)
    : index_(index),
      name_(name_of_member(index)),
      strength_(strength),
      spec_(spec),
      outside_(std::move(outside)),
      random_(seed) {}

Duration GroupMember::between(Duration least, Duration most) {
  const double chance = std::generate_canonical<double, 53>(random_);
  return least +
         Duration{static_cast<std::int64_t>(chance * static_cast<double>((most - least).count()))};
}

// ---- process

void GroupMember::start(Instant now) {
  alive_ = true;
  stopped_until_ = kLongAgo;
  held_ = std::make_unique<HeldCommands<Command>>();
  ledger_ = std::make_unique<CommandLedger>();
  elsewhere_ = begun_elsewhere_ = {};
  with_result_ = RecentCommands{HeldCommands<Command>::kResultsFor};
  join(now);
}

void GroupMember::kill() {
  note("is killed");
  outside_.wire.close(index_);
  alive_ = serving_ = handing_over_ = false;
  election_.reset();
  remembered_ = {};
  fit_since_ = joins_at_ = ready_at_ = leave_at_ = promote_by_ = give_up_at_ = release_by_ = kNever;
  inbox_.clear();
  waiting_.clear();
  late_.clear();
}

void GroupMember::stop(Duration time, Instant now) {
  note("stands still for " + to_text(time));
  stopped_until_ = now + time;
  outside_.wire.stop(index_, time);
}

void GroupMember::lost(const std::string& name) {
  if (election_) election_->lost(name, outside_.wire.now());
}

bool GroupMember::hand_over(Instant now) {
  return election_ && now >= stopped_until_ && !election_->hand_over({}, now);
}

// Joins as a waiting member, with an engine that is not started.
void GroupMember::join(Instant now) {
  joins_at_ = kNever;
  serving_ = handing_over_ = false;
  hold_ = std::make_unique<SampleHold>();
  in_hand_ = written_ = noted_ = noted_term_ = 0;
  waiting_.clear();
  late_.clear();
  others_.clear();
  released_.reset();
  followed_ = {};
  std::size_t channels = 0;
  for (const DeviceSpec& device : spec_.devices) channels += device.channels.size();
  followed_.samples.resize(channels);
  held_->join();
  outside_.wire.replace(index_, static_cast<unsigned>(random_() % WireFence::kRanks), random_());
  StandbyMember own;
  own.bridge = name_;
  own.since = now.time_since_epoch().count();
  own.strength = strength_;
  own.configuration = "the same";
  election_.emplace(own, now, remembered_);
  told_ = StandbyRole::kWaiting;
  ready_at_ = now + between(100ms, 1s);
  next_tick_ = next_beat_ = next_look_ = now;
  note("joins the group");
  outside_.joined();
}

bool GroupMember::may_send(Instant now) const {
  const bool serves =
      election_ && (election_->serves(now) || outside_.sabotage == GroupSabotage::kTwoMasters);
  return alive_ && serving_ && now >= stopped_until_ && serves;
}

Instant GroupMember::next_due() const {
  if (!alive_) return kNever;
  const Instant next =
      std::min({joins_at_, leave_at_, ready_at_, release_by_, promote_by_, give_up_at_,
                election_ ? std::min({next_tick_, next_beat_, next_look_}) : kNever});
  return std::max(next, stopped_until_);
}

void GroupMember::on_time(Instant now) {
  if (!alive_ || now < stopped_until_) return;
  const bool time_first = random_() % 2 == 0;
  if (!time_first)
    for (const GroupMessage& message : std::exchange(inbox_, {})) receive(message, now);
  if (leave_at_ <= now) leave(now);
  if (joins_at_ <= now) join(now);
  if (!election_) return;
  if (ready_at_ <= now) {
    ready_at_ = kNever;
    election_->set_not_ready("");
    beat_soon_ = true;
    fit_since_ = now;
  }
  if (next_tick_ <= now) {
    election_->on_time(now);
    next_tick_ = now + Election::kTick;
  }
  if (time_first)
    for (const GroupMessage& message : std::exchange(inbox_, {})) receive(message, now);
  follow_role(now);
  if (!election_) return;
  settle_notes(now);
  finish_begun(now);
  if (next_look_ <= now) tell_held(now);
  if (next_beat_ <= now || std::exchange(beat_soon_, false)) {
    next_beat_ = now + Election::kBeat;
    outside_.tell(message(now));
  }
}

StandbyMessage GroupMember::message(Instant now) {
  StandbyMessage told;
  told.member = election_->beat();
  told.written = written_;
  const auto master = election_->master(now);
  const auto known = master ? others_.find(*master) : others_.end();
  if (known != others_.end() && known->second.member.term == noted_term_) told.noted = noted_;
  told.buses = {{spec_.name, followed_.epoch, followed_.blocks}};
  return told;
}

// ---- role

void GroupMember::follow_role(Instant now) {
  if (!election_) return;  // a message before has made it leave
  const StandbyRole role = election_->role();
  if (role != told_) {
    if (role == StandbyRole::kMaster && told_ == StandbyRole::kWaiting) {
      written_ = 0;
      released_.reset();
      for (const auto& [name, told] : others_) {
        if (told.member.role == StandbyRole::kReleased && told.member.successor == name_ &&
            election_->is_alive(name, now) && !told.buses.empty())
          released_ = told.buses.front();
      }
      promote_by_ = released_ ? now + kLastBlocks : now;
    }
    if (role == StandbyRole::kWaiting) {
      promote_by_ = kNever;
      election_->set_not_ready("it starts again");
    }
    told_ = role;
    beat_soon_ = true;
  }
  const bool was_master = serving_ || (!handing_over_ && election_->term() != 0);
  const bool steps_back = role == StandbyRole::kWaiting && was_master &&
                          outside_.sabotage != GroupSabotage::kTwoMasters;
  if (role == StandbyRole::kMaster && !serving_ && !handing_over_) {
    promote(now);
  } else if (role == StandbyRole::kHandingOver && (serving_ || !handing_over_)) {
    release(now);
  } else if (steps_back) {
    note("steps back");
    leave(now);
  } else if (handing_over_ && role != StandbyRole::kReleased && leave_at_ == kNever) {
    leave_at_ = now + kAfterHandOver;
  }
  if (serving_ && may_send(now)) {
    publish({}, now);  // samples that were held back
    remain_master(now);
    for (const CommandResult& result : std::exchange(late_, {})) answer(result, now);
  }
}

void GroupMember::promote(Instant now) {
  const bool whole =
      released_ && followed_.epoch == released_->epoch && followed_.blocks >= released_->blocks;
  if (released_ && !whole && now < promote_by_) return;
  promote_by_ = kNever;
  const bool goes_on = followed_.epoch != 0;
  std::uint64_t greatest = 0;
  for (const Sample& sample : followed_.samples) greatest = std::max(greatest, sample.sequence);
  if (outside_.sabotage != GroupSabotage::kSequences) election_->follows(greatest);
  note(std::string("is master") + (whole ? ", was handed over to" : "") +
       (goes_on ? "" : ", begins anew"));
  ++takeovers_;
  serving_ = true;
  promoted_ = counted_since_ = now;
  counted_ = term();
  BusInheritance inherited{followed_.samples, followed_.devices, sequences_of(counted_)};
  for (Sample& sample : inherited.samples) {
    if (sample.sequence != 0 && !whole) sample.sequence += kSequenceMargin;
    if (outside_.sabotage == GroupSabotage::kSequences) sample.sequence = 0;
  }
  if (outside_.sabotage == GroupSabotage::kSequences) inherited.above = 0;
  if (!goes_on) followed_.epoch = static_cast<std::uint64_t>(now.time_since_epoch().count());
  if (goes_on && !whole) hold_->prove_until(now + kProve, now);
  outside_.wire.master(index_).engine.inherit(inherited, now);
  outside_.wire.open(index_);
  publish_again(now);
  run_held(now);
}

// Ordered hand-over: waits for running commands, then releases the bus.
void GroupMember::release(Instant now) {
  if (give_up_at_ != kNever) return;  // its own takeover is not complete
  if (!std::exchange(handing_over_, true)) {
    note("hands over");
    promote_by_ = kNever;
    held_->stand_by();
    release_by_ = now + kFinish;
  }
  if (in_hand_ > 0 && now < release_by_) return;
  let_go_of_the_bus();
  election_->released(now);
  follow_role(now);
}

void GroupMember::let_go_of_the_bus() {
  release_by_ = kNever;
  if (!serving_) return;
  outside_.wire.feed(index_, StopRequested{});
  outside_.wire.close(index_);
  serving_ = false;
}

// Leaves the group and joins it again later.
void GroupMember::leave(Instant now) {
  leave_at_ = promote_by_ = give_up_at_ = kNever;
  fit_since_ = kNever;
  let_go_of_the_bus();
  tell_last_words(now);
  StandbyMessage last = message(now);
  last.member.role = StandbyRole::kLeft;
  last.member.not_ready = "it has ended";
  outside_.tell(last);
  remembered_ = election_->memory();
  election_.reset();
  joins_at_ = now + between(300ms, 1500ms);
}

// ---- messages of other nodes

void GroupMember::receive(const GroupMessage& message, Instant now) {
  if (!alive_) return;
  if (now < stopped_until_) return inbox_.push_back(message);
  if (!election_) return;
  if (const auto* member = std::get_if<StandbyMessage>(&message)) {
    const std::string& name = member->member.bridge;
    election_->receive(member->member, now);
    others_[name] = *member;
    follow_role(now);
    if (election_) settle_notes(now);
  } else if (const auto* noted = std::get_if<StandbyNote>(&message)) {
    noted->term == 0 ? resolve_unknown(*noted, now) : on_note(*noted, now);
  } else if (const auto* block = std::get_if<GroupBlock>(&message)) {
    if (!serving_) follow(*block);
  } else if (const auto* result = std::get_if<CommandResult>(&message)) {
    if (serving_ && !held_->waits()) return;
    seen_result({result->requester, result->request_id}, now);
  } else if (const auto* command = std::get_if<Command>(&message)) {
    const Key key{command->requester, command->request_id};
    if (!held_->hold(spec_.name, key, *command, command->expires, now)) run(*command, now);
  } else if (std::holds_alternative<GroupSnapshotRequest>(message)) {
    readers_came(now);
  }
}

// Continues as master in a later term: a different member may have been master meanwhile.
void GroupMember::remain_master(Instant now) {
  if (election_->role() != StandbyRole::kMaster || counted_ == term()) return;
  counted_ = term();
  counted_since_ = now;
  note("remains master, in term " + std::to_string(number_of(counted_)));
  outside_.wire.feed(index_, CountAbove{sequences_of(counted_)});
  for (const Waiting& each : waiting_)
    tell_note(StandbyNoteKind::kBegun, {each.command.requester, each.command.request_id},
              each.number);
}

void GroupMember::on_note(const StandbyNote& note, Instant now) {
  const Key key{note.requester, note.request_id};
  give_up_begun(note, now);
  if (note.kind == StandbyNoteKind::kReturned)
    held_->returned(key);
  else if (note.kind == StandbyNoteKind::kCompleted)
    seen_result(key, now);
  else if (outside_.sabotage != GroupSabotage::kTwoRuns)
    held_->begun(note.bus, key, outside_.wire.now() + 1min);
  if (note.term < noted_term_) return;
  if (note.term > noted_term_) noted_ = 0;
  noted_term_ = note.term;
  noted_ = std::max(noted_, note.number);
  beat_soon_ = true;
  next_beat_ = outside_.wire.now();
}

void GroupMember::follow(const GroupBlock& block) {
  if (block.epoch < followed_.epoch) return;
  if (block.epoch > followed_.epoch) {
    followed_.epoch = block.epoch;
    followed_.blocks = 0;
    for (Sample& sample : followed_.samples) sample.sequence = 0;
  }
  followed_.blocks = std::max(followed_.blocks, block.number);
  if (!block.devices.empty()) followed_.devices = block.devices;
  for (const Sample& sample : block.samples) {
    Sample& known = followed_.samples[sample.channel];
    if (sample.sequence <= known.sequence) continue;
    known = sample;
  }
}

// ---- actions of its engine

void GroupMember::on_action(const Action& action, Instant now) {
  if (!alive_ || !election_) return;
  if (const auto* samples = std::get_if<Publish>(&action)) publish(samples->samples, now);
  if (const auto* done = std::get_if<Complete>(&action)) complete(done->result, now);
  const auto* notice = std::get_if<Notice>(&action);
  if (notice == nullptr) return;
  note("notice: " + notice->device + " " + notice->text);
  if (notice->kind == Notice::Kind::kForeignMaster) hold_->foreign_master(now);
}

void GroupMember::publish(std::vector<Sample> samples, Instant now) {
  samples = hold_->pass(std::move(samples), may_send(now), now);
  if (samples.empty()) return;
  GroupBlock block{followed_.epoch, ++followed_.blocks, counted_since_, term(), false, samples, {}};
  for (const Sample& sample : samples) followed_.samples[sample.channel] = sample;
  if (now >= next_report_) {
    next_report_ = now + 1s;
    for (DeviceIndex d = 0; d < spec_.devices.size(); ++d)
      block.devices[spec_.devices[d].name] =
          outside_.wire.master(index_).engine.device_report(d, now);
  }
  outside_.tell(std::move(block));
}

void GroupMember::readers_came(Instant now) {
  if (election_) election_->readers_came(now);
  publish_again(now);
}

void GroupMember::publish_again(Instant now) {
  if (!may_send(now)) return;
  GroupBlock block{followed_.epoch, ++followed_.blocks, counted_since_, term(), true, {}, {}};
  for (ChannelIndex c = 0; c < followed_.samples.size(); ++c) {
    if (followed_.samples[c].sequence != 0) block.samples.push_back(followed_.samples[c]);
  }
  outside_.tell(std::move(block));
}

}  // namespace fieldcast::test
