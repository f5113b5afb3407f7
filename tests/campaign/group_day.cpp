#include "tests/campaign/group_day.hpp"

#include <algorithm>

#include "tests/campaign/day_faults.hpp"
#include "tools/sim/device/waveform.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

// Interval between two deliveries of messages.
constexpr Duration kStep = 2ms, kLeastStep = 50us;
constexpr Duration kExpires = 20s;  // of a command

BusSpec spec_of(const StormKind& kind, std::mt19937_64& random, GroupSabotage sabotage) {
  BusSpec spec = variant_of(bus_of(kind, "200ms"), random);
  const auto base = 500ms * static_cast<int>(1 + random() % 5);
  for (DeviceSpec& device : spec.devices) {
    for (std::size_t c = 0; c < device.channels.size(); ++c) {
      ChannelSpec& channel = device.channels[c];
      channel.refresh = base * static_cast<int>(1 + c % 3);
      channel.on_interest = false;
      if (channel.deadband) channel.heartbeat = 3 * channel.refresh;
    }
  }
  if (sabotage != GroupSabotage::kDeaf)
    std::get<SerialPortSpec>(spec.port).fence.kind = Fence::kListen;
  return spec;
}

}  // namespace

void GroupCounts::add(const GroupCounts& other) {
  frames += other.frames;
  garbled += other.garbled;
  turns += other.turns;
  samples += other.samples;
  good += other.good;
  commands += other.commands;
  results += other.results;
  executed += other.executed;
  second_results += other.second_results;
  kills += other.kills;
  stops += other.stops;
  hand_overs += other.hand_overs;
  cuts += other.cuts;
  takeovers += other.takeovers;
  violations += other.violations;
}

std::vector<StormKind> group_kinds() {
  std::vector<StormKind> kinds;
  for (const StormKind& kind : storm_kinds()) {
    // Full duplex of DF1 is a line between two stations.
    if (kind.port.starts_with("{ serial") && kind.name != "allen-bradley-df1")
      kinds.push_back(kind);
  }
  return kinds;
}

GroupDay::GroupDay(const StormKind& kind, std::uint64_t seed, Duration length,
                   GroupSabotage sabotage)
    : kind_(kind),
      random_(sim::mix(seed, "group " + kind.name)),
      length_(length),
      sabotage_(sabotage),
      spec_(spec_of(kind, random_, sabotage)),
      times_(fence_times(spec_)),
      memory_(spec_, [this](DeviceIndex d) -> sim::SimDevice& { return wire_->device(d); }) {
  const std::size_t count = random_() % 4 == 0 ? 3 : 2;
  std::vector<Adapter> adapters(count);
  for (Adapter& each : adapters) {
    each.latency = random_() % 2 ? Duration{16ms} : between(0ms, 2ms);
    each.echo = random_() % 3 == 0;
  }
  WireFaults faults;
  faults.late = random_() % 3 == 0 ? 0.002 : 0;
  wire_ = std::make_unique<SharedWire>(spec_, adapters, faults, seed);
  wire_->may_send = [this](std::size_t i) { return members_[i]->may_send(now()); };
  wire_->on_action = [this](std::size_t i, const Action& action) { see_action(i, action); };
  wire_->watch = [this](Instant start, int sender, ByteView bytes) {
    see_frame(start, sender, bytes);
  };
  network_ = std::make_unique<GroupNetwork>(count + 1, random_());
  network_->loss = (random_() % 3 == 0 ? 0.05 : random_() % 2 ? 0.01 : 0);
  network_->most_delay = random_() % 2 ? 3ms : 30ms;
  one_kernel_ = random_() % 2 == 0;
  writes_.resize(spec_.devices.size());
  for (DeviceIndex d = 0; d < spec_.devices.size(); ++d) {
    memory_.fill(d, random_, now());
    for (const ChannelSpec& each : spec_.devices[d].channels)
      channels_.push_back({.device = d, .spec = &each, .gap = promised_gap(each).value_or(1h)});
  }
  memory_.begin(spec_, now());
  for (std::size_t i = 0; i < count; ++i) {
    members_.push_back(std::make_unique<GroupMember>(
        i, static_cast<std::int32_t>(random_() % 3), spec_,
        GroupMember::Outside{*wire_,
                             [this, i](GroupMessage message) { tell(i, std::move(message)); },
                             [this, i] {
                               network_->forget(i);  // a new reader gets only later messages
                               for (std::size_t to = 0; to < members_.size(); ++to)
                                 network_->apart(i, to) ? members_[to]->publish_again(now())
                                                        : members_[to]->readers_came(now());
                             },
                             [this](const std::string& text) { note(text); }, sabotage},
        random_()));
    restarts_.push_back(Instant{between(0ms, 3s)});
  }
}

GroupDay::~GroupDay() = default;

Duration GroupDay::between(Duration least, Duration most) {
  return least + Duration{static_cast<std::int64_t>(chance() *
                                                    static_cast<double>((most - least).count()))};
}

// The station does not receive the messages between members.
void GroupDay::tell(std::size_t from, GroupMessage message) {
  if (const auto* block = std::get_if<GroupBlock>(&message)) judge_values(*block);
  const bool inside = std::holds_alternative<StandbyMessage>(message) ||
                      std::holds_alternative<StandbyNote>(message);
  const std::size_t station = members_.size();
  const auto shared = std::make_shared<const GroupMessage>(std::move(message));
  for (std::size_t to = 0; to <= station; ++to) {
    if (to != from && !(inside && to == station)) network_->send(from, to, shared, now());
  }
}

void GroupDay::run(const std::function<bool()>& stop) {
  const Instant end = Instant{} + length_;
  while (now() < end && !violation_) {
    run_until(std::min(end, now() + between(500ms, 15s)));
    if (stop && stop()) return;
    if (!violation_) operate();
  }
}

void GroupDay::run_until(Instant until) {
  Instant next_sweep = now() + 500ms;
  while (now() < until && !violation_) {
    Instant next = std::min({until, now() + kStep, network_->next_due(), heal_at_});
    for (const auto& member : members_) next = std::min(next, member->next_due());
    wire_->run_until(std::min(until, std::max(next, now() + kLeastStep)));
    if (heal_at_ <= now()) {
      heal_at_ = kNever;
      healed_ = now();
      note("-- the network is whole");
      if (network_->heal(now())) {
        for (const auto& member : members_) member->readers_came(now());
      }
    }
    ask_for_samples();
    network_->deliver(now(), [this](std::size_t to, const GroupMessage& message) {
      if (to < members_.size()) return members_[to]->receive(message, now());
      if (const auto* block = std::get_if<GroupBlock>(&message)) see_block(*block);
      if (const auto* result = std::get_if<CommandResult>(&message)) see_result(*result);
    });
    restart_members();
    for (const auto& member : members_) {
      if (member->next_due() <= now()) member->on_time(now());
    }
    judge_masters();
    if (now() < next_sweep) continue;
    next_sweep = now() + 500ms;
    sweep();
  }
}

void GroupDay::restart_members() {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    if (restarts_[i] > now()) continue;
    restarts_[i] = kNever;
    members_[i]->start(now());
  }
}

std::vector<std::size_t> GroupDay::living() const {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    if (members_[i]->alive()) found.push_back(i);
  }
  return found;
}

void GroupDay::operate() {
  const double chosen = chance();
  if (chance() < 0.5) command();
  if (chosen < 0.12)
    kill();
  else if (chosen < 0.22)
    stop_one();
  else if (chosen < 0.3)
    hand_over();
  else if (chosen < 0.34)
    cut();
  else if (chosen < 0.4)
    memory_.fill(static_cast<DeviceIndex>(random_() % spec_.devices.size()), random_, now());
  if (chance() < 0.5) command();
}

void GroupDay::kill() {
  const auto alive = living();
  if (alive.empty()) return;
  const std::size_t index = alive[random_() % alive.size()];
  ++counts_.kills;
  for (int i = chance() < 0.5 ? 3 : 0; i > 0; --i) command();
  run_until(now() + between(0ms, 60ms));
  members_[index]->kill();
  network_->forget(index);
  restarts_[index] = now() + between(1s, 30s);
  if (!one_kernel_) return;
  for (const auto& member : members_) member->lost(members_[index]->name());
}

void GroupDay::stop_one() {
  const auto alive = living();
  if (alive.empty()) return;
  ++counts_.stops;
  const Duration time = chance() < 0.5 ? between(10ms, 400ms) : between(400ms, 5s);
  members_[alive[random_() % alive.size()]]->stop(time, now());
}

void GroupDay::hand_over() {
  for (int i = chance() < 0.5 ? 3 : 0; i > 0; --i) command();
  run_until(now() + between(0ms, 60ms));
  for (const auto& member : members_) {
    if (member->alive() && member->serving() && member->hand_over(now())) {
      ++counts_.hand_overs;
      return;
    }
  }
}

void GroupDay::cut() {
  if (network_->is_cut()) return;
  std::vector<bool> side(members_.size() + 1);
  for (std::size_t i = 0; i < side.size(); ++i) side[i] = random_() % 2 == 0;
  if (std::ranges::count(side, side[0]) == static_cast<std::ptrdiff_t>(side.size()))
    side[0] = !side[0];
  ++counts_.cuts;
  std::string text = "-- the network is cut:";
  for (const bool each : side) text += each ? " 1" : " 0";
  note(text);
  network_->cut(side, now());
  heal_at_ = now() + (chance() < 0.5 ? between(100ms, 3s) : between(3s, 40s));
}

// Like BlockSubscription if BusTable::is_behind().
void GroupDay::ask_for_samples() {
  const bool behind =
      std::ranges::any_of(channels_, [](const Channel& channel) { return channel.below >= 2; });
  if (!behind) {
    ask_at_ = kNever;
    ask_rest_ = 1s;
    return;
  }
  if (ask_at_ == kNever) ask_at_ = now() + ask_rest_;
  if (now() < ask_at_) return;
  ask_rest_ = std::min(2 * ask_rest_, Duration{1min});
  ask_at_ = now() + ask_rest_;
  note("station: asks for the last values");
  const auto shared = std::make_shared<const GroupMessage>(GroupSnapshotRequest{});
  for (std::size_t to = 0; to < members_.size(); ++to)
    network_->send(members_.size(), to, shared, now());
}

// Sends a write of a new value, or a read.
void GroupDay::command() {
  const auto index = static_cast<ChannelIndex>(random_() % channels_.size());
  const Channel& channel = channels_[index];
  Command command;
  command.requester = "campaign";
  command.request_id = next_command_++;
  command.device = spec_.devices[channel.device].name;
  command.target = ChannelTarget{channel.spec->name};
  command.expires = now() + kExpires;
  Pending pending{index, std::nullopt, now(), {}};
  if (!kind_.writes || chance() < 0.3) {
    command.operation = Operation::kAcquire;
  } else {
    pending.written = random_() % 65'536;
    command.values = {*pending.written};
    command.verify = chance() < 0.3;
    ++writes_[channel.device].sent;
  }
  note("command " + std::to_string(command.request_id) + " channel " + std::to_string(index) +
       (pending.written ? " = " + to_text(*pending.written) : std::string{" ?"}));
  ++counts_.commands;
  pending_.emplace(command.request_id, std::move(pending));
  const auto shared = std::make_shared<const GroupMessage>(std::move(command));
  for (std::size_t to = 0; to < members_.size(); ++to)
    network_->send(members_.size(), to, shared, now());
}

GroupCounts GroupDay::counts() const {
  GroupCounts counts = counts_;
  counts.frames = wire_->counts().frames;
  counts.garbled = wire_->counts().garbled;
  counts.turns = wire_->counts().turns;
  for (const auto& member : members_) counts.takeovers += member->takeovers();
  for (std::size_t d = 0; d < spec_.devices.size(); ++d)
    counts.executed += wire_->device(d).statistics().write_requests;
  return counts;
}

}  // namespace fieldcast::test
