#include "tests/campaign/bus_day.hpp"

#include <malloc.h>

#include <algorithm>

#include "tests/campaign/day_faults.hpp"
#include "tools/sim/device/waveform.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

constexpr Duration kExpires = 20s;  // of a command
constexpr std::size_t kMemoryMayGrow = 512 * 1024;

std::size_t allocated() {
  const auto info = ::mallinfo2();
  return info.uordblks + info.hblkhd;
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
    : kind_(kind),
      random_(sim::mix(seed, kind.name)),
      length_(length),
      whole_(bus_of(kind, "200ms")),
      memory_(whole_, [this](DeviceIndex d) -> sim::SimDevice& {
        return *bus_->plant().members()[d].device;
      }) {
  const sim::BusFaults faults = bus_faults(kind, whole_, random_, length);
  for (int v = 0; v < 4; ++v) variants_.push_back(variant_of(whole_, random_));
  for (DeviceIndex d = 0; d < whole_.devices.size(); ++d) {
    for (const auto& window : faults.devices.at(whole_.devices[d].name).silence)
      restarts_.emplace_back(window.to, d);
    dead_until_.push_back(Instant{});
  }
  std::ranges::sort(restarts_);
  bus_ = std::make_unique<sim::VirtualBus>(whole_, faults, seed,
                                           [this](const Action& action) { see(action); });
  bus_->on_received = [this](ByteView bytes) {
    if (transcribing_) note("<< " + to_hex(bytes));
  };
  for (DeviceIndex d = 0; d < whole_.devices.size(); ++d) memory_.fill(d, random_, now());
  begin(1s);  // the plant's first engine has ended, and its responses have expired
}

BusDay::~BusDay() = default;

void BusDay::keep_transcript() { transcribing_ = true; }

Duration BusDay::between(Duration least, Duration most) {
  return least + Duration{static_cast<std::int64_t>(chance() *
                                                    static_cast<double>((most - least).count()))};
}

// Starts the engine of the present variant after `absence`, with the channels of that variant.
void BusDay::begin(Duration absence, const Opened& opened) {
  channels_.clear();
  const BusSpec& spec = variants_[variant_];
  for (DeviceIndex d = 0; d < spec.devices.size(); ++d) {
    for (const ChannelSpec& each : spec.devices[d].channels) {
      Channel channel{.device = d,
                      .spec = &each,
                      .published = now() + absence,
                      .gap = each.on_interest ? std::nullopt : promised_gap(each)};
      channels_.push_back(std::move(channel));
    }
  }
  memory_.begin(spec, now());
  busy_ = true;
  disturbed_ = now() + absence;
  bus_->replace_engine(spec, absence, opened);
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
    memory_.fill(device, random_, now());
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

// A reload (`in_order`) continues immediately and keeps the pending requests. A takeover from a
// killed process has no list of them, so it starts later: a protocol without numbers cannot detect
// old responses that arrive later than three timeouts after their request.
void BusDay::replace_engine(bool in_order) {
  Opened opened;
  if (in_order) {
    if (transcribing_) note("-- reload");
    ++counts_.reloads;
    bus_->feed(StopRequested{});
    if (!pending_.empty())
      return violate("a stop left command " + std::to_string(pending_.begin()->first) +
                     " without a result");
    opened.quiet_until = bus_->engine().responses_until();
    variant_ = random_() % variants_.size();
  } else {
    if (transcribing_) note("-- the engine is killed");
    ++counts_.takeovers;
    pending_.clear();  // the successor reports their results from the store
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

// Sends a write of a new value, a read, or a command that must be refused.
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
