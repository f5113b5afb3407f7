#include "tests/campaign/bus_day.hpp"

#include <malloc.h>

#include <algorithm>
#include <stdexcept>

#include "core/codec/value_codec.hpp"
#include "core/model/make_protocol.hpp"
#include "tools/sim/device/waveform.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

// The last part of a day is calm.
constexpr Duration kCalm = 20min;
// A channel that nothing hinders is good within this time and some of its refreshes. The longest
// death of a device, which is noted when it ends, is within it.
constexpr Duration kChannelMustBeGood = 8min;
// An answer that was late by this much may still tell the value of before.
constexpr Duration kOldValueMayCome = 2s;
constexpr Duration kTellTolerance = 10ms;
constexpr Duration kExpires = 20s;       // of a command
constexpr Duration kResultWithin = 30s;  // of its sending
constexpr std::size_t kMemoryMayGrow = 512 * 1024;
// Whether what is wrong with an answer is always seen: by a CRC, or since each error is one
// character. Collisions with another master garble many at once, which a sum of 8 bits lets pass
// once in 256 times.
bool has_crc(const std::string& protocol) { return protocol.starts_with("modbus-"); }

double one_of(std::mt19937_64& random, std::initializer_list<double> values) {
  return values.begin()[random() % values.size()];
}

sim::DeviceFaults device_faults(std::mt19937_64& random, Duration length, bool tcp) {
  constexpr Duration kLate[] = {80ms, 150ms, 205ms, 250ms, 320ms, 450ms, 560ms};
  sim::DeviceFaults faults;
  faults.queues = true;
  faults.delay.base = std::chrono::milliseconds{1 + random() % 20};
  faults.delay.spread = std::chrono::milliseconds{random() % 10};
  if (random() % 4 == 0) return faults;  // a healthy one
  faults.loss = one_of(random, {0, 0.001, 0.01, 0.05});
  faults.late_probability = one_of(random, {0, 0.001, 0.01, 0.05});
  faults.late = kLate[random() % std::size(kLate)];
  faults.doubled = one_of(random, {0, 0.001, 0.02});
  // On a TCP stream half an answer comes with the end of the connection only.
  if (!tcp) faults.truncate = one_of(random, {0, 0.001, 0.02});
  for (Duration from{};;) {
    from += std::chrono::seconds{600 + random() % 14'400};
    const Duration to = from + std::chrono::seconds{1 + random() % 300};
    if (to > length - kCalm) return faults;
    faults.silence.push_back({from, to});
    from = to;
  }
}

sim::BusFaults bus_faults(const StormKind& kind, const BusSpec& spec, std::mt19937_64& random,
                          Duration length) {
  sim::BusFaults faults;
  // Nothing checks the answers of the one, and of the other TCP does.
  const bool tcp = std::holds_alternative<TcpPortSpec>(spec.port);
  if (kind.protocol != "s7-freeport" && !tcp) faults.noise = one_of(random, {0, 1e-7, 1e-6});
  if (has_crc(kind.protocol) && kind.protocol != "modbus-ascii")
    faults.foreign = one_of(random, {0, 0, 0.002});
  for (const DeviceSpec& device : spec.devices)
    faults.devices[device.name] = device_faults(random, length, tcp);
  return faults;
}

// Bytes of memory in use by this process.
std::size_t allocated() {
  const auto info = ::mallinfo2();
  return info.uordblks + info.hblkhd;
}

// Some channels of each device, with other refreshes than those of the last variant.
BusSpec variant_of(const BusSpec& whole, std::mt19937_64& random) {
  BusSpec spec = whole;
  const auto base = std::chrono::seconds{5 + random() % 56};
  if (random() % 5 == 0) spec.planner = Planner::kDynamicBlocks;
  for (DeviceSpec& device : spec.devices) {
    while (device.channels.size() > 6)
      device.channels.erase(device.channels.begin() +
                            static_cast<std::ptrdiff_t>(random() % device.channels.size()));
    for (std::size_t c = 0; c < device.channels.size(); ++c) {
      ChannelSpec& channel = device.channels[c];
      channel.refresh = base * static_cast<int>(1 + c % 3);
      if (c == 3 && channel.encoding.type != ValueType::kBool) channel.deadband = 0.5;
      if (channel.deadband) channel.heartbeat = 3 * channel.refresh;
      if (c == 4) channel.on_interest = true;
    }
  }
  return spec;
}

}  // namespace

void DayCounts::add(const DayCounts& other) {
  requests += other.requests;
  samples += other.samples;
  good += other.good;
  late += other.late;
  doubled += other.doubled;
  commands += other.commands;
  results += other.results;
  done += other.done;
  unplugged += other.unplugged;
  reloads += other.reloads;
  takeovers += other.takeovers;
  leases += other.leases;
  interests += other.interests;
  device_restarts += other.device_restarts;
  violations += other.violations;
}

BusDay::BusDay(const StormKind& kind, std::uint64_t seed, Duration length)
    : kind_(kind), random_(sim::mix(seed, kind.name)), length_(length) {
  const BusSpec whole = bus_of(kind, "200ms");
  const sim::BusFaults faults = bus_faults(kind, whole, random_, length);
  for (int v = 0; v < 4; ++v) variants_.push_back(variant_of(whole, random_));
  for (DeviceIndex d = 0; d < whole.devices.size(); ++d) {
    protocols_.push_back(std::move(*make_protocol(whole.devices[d], line_of(whole.port))));
    for (const auto& window : faults.devices.at(whole.devices[d].name).silence)
      restarts_.emplace_back(window.to, d);
    dead_until_.push_back(Instant{});
  }
  std::ranges::sort(restarts_);
  bus_ = std::make_unique<sim::VirtualBus>(whole, faults, seed,
                                           [this](const Action& action) { see(action); });
  bus_->on_received = [this](ByteView bytes) {
    if (transcribing_) note("<< " + to_hex(bytes));
  };
  for (DeviceIndex d = 0; d < whole.devices.size(); ++d) poke_all(d);
  begin(1s);  // the engine that began with the plant has gone, and its answers
}

BusDay::~BusDay() = default;

void BusDay::keep_transcript() { transcribing_ = true; }

Duration BusDay::between(Duration least, Duration most) {
  return least + Duration{static_cast<std::int64_t>(chance() *
                                                    static_cast<double>((most - least).count()))};
}

// The engine of the variant in force begins after `absence`, with the channels of that variant.
void BusDay::begin(Duration absence, const Opened& opened) {
  channels_.clear();
  const BusSpec& spec = variants_[variant_];
  for (DeviceIndex d = 0; d < spec.devices.size(); ++d) {
    for (const ChannelSpec& each : spec.devices[d].channels) {
      Channel channel{.device = d,
                      .spec = &each,
                      .area = &protocols_[d]->areas()[each.range.area],
                      .published = now() + absence,
                      .gap = each.on_interest ? std::nullopt : promised_gap(each)};
      channel.holds = channel.held = memory(channel);
      channels_.push_back(std::move(channel));
    }
  }
  busy_ = true;
  disturbed_ = now() + absence;
  bus_->replace_engine(spec, absence, opened);
}

// New contents, as after a restart of the device.
void BusDay::poke_all(DeviceIndex device) {
  ++generation_;
  sim::SimDevice& simulated = *bus_->plant().members()[device].device;
  for (const ChannelSpec& channel : bus_->plant().spec().devices[device].channels) {
    const Area& area = protocols_[device]->areas()[channel.range.area];
    for (std::uint32_t i = channel.range.first; i < channel.range.end(); ++i) {
      const std::uint64_t bits = random_();
      if (!simulated.poke(area.name, i,
                          area.item_bits >= 64 ? bits : bits >> (64 - area.item_bits)))
        throw std::runtime_error(kind_.name + " has no " + std::string(area.name));
    }
  }
  for (Channel& channel : channels_) {
    if (channel.device == device) changed(channel);
  }
}

Value BusDay::memory(const Channel& channel) const {
  sim::SimDevice& device = *bus_->plant().members()[channel.device].device;
  const unsigned bits = channel.area->item_bits;
  Bytes image;
  for (std::uint32_t i = channel.spec->range.first; i < channel.spec->range.end(); ++i) {
    const std::uint64_t item = device.peek(channel.area->name, i, now()).value_or(0);
    for (unsigned left = bits; left >= 8; left -= 8)
      image.push_back(static_cast<std::uint8_t>(item >> (left - 8)));
    if (bits < 8) image.push_back(static_cast<std::uint8_t>(item));
  }
  auto value = decode_value(channel.spec->encoding, bits, image);
  if (!value) throw std::runtime_error(channel.spec->name + ": no value");
  return std::move(*value);
}

// Looks what the device holds by now.
void BusDay::changed(Channel& channel) {
  Value value = memory(channel);
  if (value == channel.holds) return;
  channel.held = std::move(channel.holds);
  channel.holds = std::move(value);
  channel.changed = now();
}

void BusDay::run(const std::function<bool()>& stop) {
  const Instant end = Instant{} + length_;
  Instant next_hour = now() + 1h;
  while (now() < end && !violation_) {
    operate();
    for (const Instant until = std::min(end, now() + between(1s, 120s));
         now() < until && !violation_;) {
      Instant next = until;
      if (restarted_ < restarts_.size())
        next = std::min(next, std::max(now(), Instant{} + restarts_[restarted_].first));
      bus_->run_until(next);
      restart_devices();
    }
    sweep();
    if (stop && stop()) return;
    if (now() < next_hour) continue;
    next_hour += 1h;
    const std::size_t bytes = allocated();
    if (sabotage_ == Sabotage::kMemory)
      kept_.push_back(std::make_unique<Bytes>(200 * 1024, std::uint8_t{1}));
    if (now() - Instant{} < 3h)
      first_bytes_ = std::max(first_bytes_, bytes);
    else if (!transcribing_ && bytes > first_bytes_ + kMemoryMayGrow)
      violate("memory grew from " + std::to_string(first_bytes_) + " to " + std::to_string(bytes) +
              " bytes");
  }
  if (violation_) return;
  bus_->feed(StopRequested{});
  if (!pending_.empty())
    violate("a stop left command " + std::to_string(pending_.begin()->first) + " without a result");
}

void BusDay::restart_devices() {
  while (restarted_ < restarts_.size() && now() - Instant{} >= restarts_[restarted_].first) {
    const DeviceIndex device = restarts_[restarted_++].second;
    ++counts_.device_restarts;
    dead_until_[device] = now();
    if (transcribing_) note("device " + std::to_string(device + 1) + " is back, with new values");
    poke_all(device);
  }
}

// What must hold although nothing happens.
void BusDay::sweep() {
  for (const auto& [id, pending] : pending_) {
    if (now() - pending.sent > kResultWithin)
      return violate("command " + std::to_string(id) + " has no result");
  }
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    const Channel& channel = channels_[c];
    if (channel.shown_good && channel.gap &&
        now() - channel.published > *channel.gap + kTellTolerance)
      return violate("channel " + std::to_string(c) + " is shown good, and silent for " +
                     to_text(now() - channel.published));
    const Instant undisturbed =
        std::max({channel.last_good, channel.promised, disturbed_, dead_until_[channel.device]});
    if (channel.gap && now() - undisturbed > kChannelMustBeGood + 5 * *channel.gap)
      return violate("channel " + std::to_string(c) + " is not read, although nothing hinders it");
  }
}

void BusDay::operate() {
  if (now() - Instant{} > length_ - kCalm) return;
  const double chosen = chance();
  if (chosen < 0.006) return lease();
  if (chosen < 0.012) return unplug();
  if (chosen < 0.017) return replace_engine(true);
  if (chosen < 0.022) return replace_engine(false);
  if (chosen < 0.08) return interest();
  if (chosen < 0.09) {
    for (int i = 0; i < 20; ++i) command();
  }
  if (chosen < 0.7) command();
}

// A reload goes on at once, and knows what was asked. Who takes over from another process does not:
// answers from before that come later than three timeouts after their request are beyond what a
// protocol without numbers can tell.
void BusDay::replace_engine(bool in_order) {
  Opened opened;
  if (in_order) {
    if (transcribing_) note("-- reload");
    ++counts_.reloads;
    bus_->feed(StopRequested{});
    if (!pending_.empty())
      return violate("a stop left command " + std::to_string(pending_.begin()->first) +
                     " without a result");
    opened.quiet_until = bus_->engine().answers_until();
    variant_ = random_() % variants_.size();
  } else {
    if (transcribing_) note("-- the engine is killed");
    ++counts_.takeovers;
    pending_.clear();  // their results are the successor's, by the store
  }
  begin(in_order ? between(1ms, 200ms) : between(700ms, 1500ms), opened);
}

void BusDay::lease() {
  ++counts_.leases;
  if (transcribing_) note("-- lease");
  leased_ = true;
  bus_->feed(LeaseBegan{"engineer"});
  bus_->run_until(now() + between(1s, 300s));
  leased_ = false;
  disturbed_ = now();
  if (transcribing_) note("-- lease ended");
  bus_->feed(LeaseEnded{});
}

void BusDay::unplug() {
  ++counts_.unplugged;
  if (transcribing_) note("-- unplugged");
  bus_->unplug();
  bus_->run_until(now() + between(10ms, 120s));
  disturbed_ = now();
  if (transcribing_) note("-- plugged");
  bus_->plug();
}

void BusDay::interest() {
  ++counts_.interests;
  const auto channel = static_cast<ChannelIndex>(random_() % channels_.size());
  std::optional<Duration> refresh;
  if (chance() < 0.6) refresh = between(500ms, 5s);
  if (transcribing_)
    note("-- interest in " + std::to_string(channel) + ": " +
         (refresh ? to_text(*refresh) : "none"));
  bus_->feed(InterestChanged{channel, refresh});
}

// A write of a new value, a read, or something that must be refused.
void BusDay::command() {
  const auto index = static_cast<ChannelIndex>(random_() % channels_.size());
  const Channel& channel = channels_[index];
  Command command;
  command.requester = "campaign";
  command.request_id = next_command_++;
  command.device = variants_[variant_].devices[channel.device].name;
  command.target = ChannelTarget{chance() < 0.02 ? "nobody" : channel.spec->name};
  command.expires = now() + (chance() < 0.1 ? Duration{1ms} : kExpires);
  Pending pending{index, std::nullopt, now()};
  if (!kind_.writes || chance() < 0.4) {
    command.operation = Operation::kAcquire;
  } else {
    pending.written = chance() < 0.02 ? std::uint64_t{70'000} : random_() % 65'536;
    command.values = {*pending.written};
    command.verify = chance() < 0.5;
  }
  if (transcribing_)
    note("command " + std::to_string(command.request_id) + " channel " + std::to_string(index) +
         (pending.written ? " = " + to_text(*pending.written) : std::string{" ?"}));
  ++counts_.commands;
  pending_.emplace(command.request_id, std::move(pending));
  bus_->feed(CommandArrived{std::move(command)});
}

void BusDay::see(const Action& action) {
  if (!busy_ || violation_) return;
  if (const auto* send = std::get_if<Send>(&action)) see_send(*send);
  if (const auto* publish = std::get_if<Publish>(&action)) {
    for (const Sample& sample : publish->samples) see_sample(sample);
  }
  if (const auto* promise = std::get_if<Promise>(&action)) {
    Channel& channel = channels_[promise->channel];
    channel.gap = promise->gap;
    channel.published = channel.promised = now();
  }
  if (const auto* complete = std::get_if<Complete>(&action)) {
    if (sabotage_ == Sabotage::kNoResult && counts_.results > 20) return;
    see_result(complete->result);
    if (sabotage_ == Sabotage::kTwoResults && counts_.results > 20) see_result(complete->result);
  }
  if (const auto* timer = std::get_if<SetTimer>(&action); timer && timer->at < now())
    violate("a timer in the past");
  if (!transcribing_) return;
  if (const auto* notice = std::get_if<Notice>(&action))
    note("notice " + notice->device + " " + notice->text);
  if (const auto* reopen = std::get_if<Reopen>(&action)) note("reopen " + reopen->reason);
}

void BusDay::see_send(const Send& send) {
  ++counts_.requests;
  if (transcribing_) note(">> " + to_hex(send.bytes));
  if (!bus_->plugged()) return violate("a request was sent into a closed port");
  if (leased_) return violate("a request was sent into a leased port");
  if (now() < wire_free_) return violate("a request was sent into the one before");
  const auto characters = static_cast<std::int64_t>(send.bytes.size());
  wire_free_ = now() + line_of(variants_[variant_].port).characters(1) * characters;
  if (sabotage_ == Sabotage::kOverlap && counts_.requests == 1000) see_send(send);
}

void BusDay::see_sample(const Sample& sample) {
  ++counts_.samples;
  Channel& channel = channels_[sample.channel];
  if (transcribing_)
    note("sample " + std::to_string(sample.channel) + " = " + to_text(sample.value) + " " +
         std::string(to_text(sample.quality)));
  if (sabotage_ == Sabotage::kSilence && sample.channel == 0 && now() - Instant{} > 1h) return;
  if (channel.shown_good && channel.gap &&
      now() - channel.published > *channel.gap + kTellTolerance)
    violate("channel " + std::to_string(sample.channel) + " was good, and silent for " +
            to_text(now() - channel.published));
  channel.published = now();
  channel.shown_good = sample.quality == Quality::kGood;
  if (!channel.shown_good) return;
  ++counts_.good;
  channel.last_good = now();
  if (sample.acquired > now()) violate("acquired in the future");
  const bool wrong = sabotage_ == Sabotage::kValue && counts_.good == 1000;
  judge(sample.channel, wrong ? Value{std::string{"wrong"}} : sample.value);
}

void BusDay::see_result(const CommandResult& result) {
  const auto found = pending_.find(result.request_id);
  if (transcribing_)
    note("result " + std::to_string(result.request_id) + " " + std::string(to_text(result.state)) +
         " " + result.reason);
  if (found == pending_.end())
    return violate("a second result for command " + std::to_string(result.request_id));
  ++counts_.results;
  const Pending pending = std::move(found->second);
  pending_.erase(found);
  judge_done(pending, result);
}

void BusDay::judge(ChannelIndex index, const Value& value) {
  Channel& channel = channels_[index];
  if (value == channel.holds) return;
  changed(channel);
  if (value == channel.holds) return;
  if (value == channel.held && now() - channel.changed < kOldValueMayCome) return;
  violate("channel " + std::to_string(index) + " shows " + to_text(value) + " as good, it holds " +
          to_text(channel.holds));
}

// What is said to be done has been done; and what was read back is what the device held.
void BusDay::judge_done(const Pending& pending, const CommandResult& result) {
  Channel& channel = channels_[pending.channel];
  if (pending.written) changed(channel);
  const bool done = result.state == CommandState::kDone || result.state == CommandState::kVerified;
  if (!done) return;
  ++counts_.done;
  for (const Value& value : result.values) judge(pending.channel, value);
  const bool restarted =
      restarted_ > 0 && Instant{} + restarts_[restarted_ - 1].first >= pending.sent;
  if (pending.written && channel.holds != *pending.written && !restarted)
    violate("command " + std::to_string(result.request_id) + " is done, but the device holds " +
            to_text(channel.holds) + " instead of " + to_text(*pending.written));
}

void BusDay::note(std::string text) {
  if (violation_ && !text.starts_with("VIOLATION")) return;
  transcript_.push_back(to_text(now() - Instant{}) + "  " + std::move(text));
  if (transcript_.size() > kTranscriptLines) transcript_.pop_front();
}

void BusDay::violate(const std::string& what) {
  if (violation_) return;
  ++counts_.violations;
  violation_ = what + ", at " + to_text(now() - Instant{});
  if (transcribing_) note("VIOLATION: " + what);
}

DayCounts BusDay::counts() const {
  DayCounts counts = counts_;
  for (const auto& member : bus_->plant().members()) {
    counts.late += member.dice.late();
    counts.doubled += member.dice.doubled();
  }
  return counts;
}

}  // namespace fieldcast::test
