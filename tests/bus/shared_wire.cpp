#include "tests/bus/shared_wire.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace fieldcast::test {

SharedWire::SharedWire(const BusSpec& spec, const std::vector<Adapter>& masters,
                       const WireFaults& faults, std::uint64_t seed)
    : spec_(spec), faults_(faults), character_(line_of(spec.port).characters(1)), random_(seed) {
  for (std::size_t i = 0; i < masters.size(); ++i) {
    masters_.push_back(std::make_unique<Master>(spec_, masters[i]));
    masters_.back()->engine.set_fence_order(static_cast<unsigned>(i), seed * 31 + i);
  }
  for (const DeviceSpec& device : spec_.devices) {
    const sim::DeviceKind* kind = sim::kind_of(device);
    if (kind == nullptr) throw std::runtime_error("no simulated device speaks " + device.protocol);
    auto made = kind->make({.spec = device,
                            .line = line_of(spec_.port),
                            .first_on_bus = devices_.empty(),
                            .seed = seed,
                            .start = Instant{}});
    if (!made) throw std::runtime_error(made.error());
    Device here{.device = std::move(*made)};
    here.receiver = here.device->open_receiver();
    half_duplex_ = half_duplex_ && kind->half_duplex;
    devices_.push_back(std::move(here));
  }
  plan_noise();
}

void SharedWire::open(std::size_t index) {
  Master& master = *masters_[index];
  master.open = true;
  master.received.clear();
  master.deliver_at = kNever;
  feed(index, Opened{});
}

void SharedWire::close(std::size_t index) {
  Master& master = *masters_[index];
  master.open = false;
  master.timer = master.deliver_at = kNever;
}

void SharedWire::replace(std::size_t index, unsigned rank, std::uint64_t seed) {
  const Master& before = *masters_[index];
  auto made = std::make_unique<Master>(spec_, before.adapter);
  made->cut = before.cut;
  made->stopped_until = before.stopped_until;
  made->engine.set_fence_order(rank, seed);
  masters_[index] = std::move(made);
}

Instant SharedWire::due_of(const Master& master) const {
  if (!master.open) return kNever;
  return std::max(std::min(master.timer, master.deliver_at), master.stopped_until);
}

// As in the runner, received bytes are delivered before a timer is handled.
void SharedWire::serve(std::size_t index) {
  Master& master = *masters_[index];
  const bool was_stopped = master.stopped_until != kLongAgo;
  master.stopped_until = kLongAgo;
  if (!master.received.empty() && (master.deliver_at <= now_ || was_stopped)) {
    const Bytes bytes = std::exchange(master.received, {});
    master.deliver_at = kNever;
    feed(index, Received{bytes});
  }
  if (master.timer <= now_) {
    master.timer = kNever;
    feed(index, TimerFired{});
  }
}

void SharedWire::run_until(Instant until) {
  for (;;) {
    Instant due = std::min(noise_at_, silence_due());
    Transmission* first = nullptr;
    for (Transmission& each : transmissions_) {
      const Instant end = each.end_of(each.passed, character_);
      if (first == nullptr || end < first->end_of(first->passed, character_)) first = &each;
    }
    const Instant wire_due = first ? first->end_of(first->passed, character_) : kNever;
    due = std::min(due, wire_due);
    std::size_t next = masters_.size();
    for (std::size_t i = 0; i < masters_.size(); ++i) {
      if (due_of(*masters_[i]) >= due) continue;
      due = due_of(*masters_[i]);
      next = i;
    }
    if (due > until) break;
    now_ = std::max(now_, due);
    if (next < masters_.size()) {
      serve(next);
    } else if (wire_due <= due) {
      pass(*first);
    } else if (noise_at_ <= due) {
      const Bytes character{static_cast<std::uint8_t>(random_())};
      transmit(kNoise, character, now_);
      plan_noise();
    } else {
      for (std::size_t i = 0; i < devices_.size(); ++i) {
        if (devices_[i].receiver->silence_due() > now_) continue;
        sim::Reaction reaction;
        devices_[i].receiver->on_silence(now_, reaction);
        react(i, reaction, now_);
      }
    }
  }
  now_ = until;
}

void SharedWire::plan_noise() {
  if (faults_.noise <= 0) return;
  std::exponential_distribution<double> wait(faults_.noise);
  noise_at_ = now_ + Duration{static_cast<std::int64_t>(wait(random_) * 1e9) + 1};
}

Instant SharedWire::silence_due() const {
  if (!transmissions_.empty()) return kNever;
  Instant due = kNever;
  for (const Device& device : devices_) due = std::min(due, device.receiver->silence_due());
  return due;
}

void SharedWire::collide(Transmission& a, Transmission& b) {
  if (a.sender == b.sender || a.sender == kNoise || b.sender == kNoise || !half_duplex_) return;
  bool any = false;
  for (std::size_t i = a.passed; i < a.characters.size(); ++i) {
    for (std::size_t k = b.passed; k < b.characters.size(); ++k) {
      const bool apart = a.end_of(i, character_) <= b.end_of(k, character_) - character_ ||
                         b.end_of(k, character_) <= a.end_of(i, character_) - character_;
      if (apart) continue;
      a.spoilt[i] = b.spoilt[k] = any = true;
    }
  }
  if (!any) return;
  const bool devices = a.sender >= kDevices && b.sender >= kDevices;
  for (Transmission* each : {&a, &b}) {
    if (std::exchange(each->garbled, true)) continue;
    ++(devices ? counts_.garbled_answers : counts_.garbled);
  }
}

void SharedWire::transmit(int sender, ByteView characters, Instant start) {
  Transmission made{sender, {characters.begin(), characters.end()}, start};
  made.spoilt.resize(characters.size());
  for (Transmission& other : transmissions_) collide(made, other);
  if (watch && sender != kNoise) watch(start, sender < kDevices ? sender : -1, characters);
  transmissions_.push_back(std::move(made));
}

void SharedWire::note_turn(std::size_t index, Instant start) {
  const int master = static_cast<int>(index);
  if (last_master_ >= 0 && last_master_ != master) {
    ++counts_.turns;
    counts_.shortest_turn = std::min(
        counts_.shortest_turn, transmissions_.empty() ? start - wire_silent_since_ : Duration{});
  }
  last_master_ = master;
  ++counts_.frames;
}

void SharedWire::pass(Transmission& transmission) {
  const std::size_t index = transmission.passed++;
  const int sender = transmission.sender;
  const Instant end = transmission.end_of(index, character_);
  std::uint8_t character = transmission.characters[index];
  if (transmission.spoilt[index]) character ^= static_cast<std::uint8_t>(1 + random_() % 255);
  if (transmission.passed == transmission.characters.size()) {
    transmissions_.erase(transmissions_.begin() + (&transmission - transmissions_.data()));
    if (transmissions_.empty()) wire_silent_since_ = end;
  }
  to_devices(sender, character, end);
  to_masters(sender, character, end);
}

void SharedWire::to_devices(int sender, std::uint8_t character, Instant end) {
  for (std::size_t i = 0; i < devices_.size(); ++i) {
    if (sender == kDevices + static_cast<int>(i)) continue;
    if (half_duplex_ && devices_[i].sends_until > end)
      continue;  // a sending device does not receive
    sim::Reaction reaction;
    devices_[i].receiver->on_character(character, end, reaction);
    react(i, reaction, end);
  }
}

void SharedWire::react(std::size_t index, sim::Reaction& reaction, Instant at) {
  if (reaction.response.empty()) return;
  Device& device = devices_[index];
  Duration after = faults_.answer_after + reaction.pause;
  if (faults_.late > 0 && std::bernoulli_distribution(faults_.late)(random_))
    after += faults_.late_by;
  const Instant start = std::max(at + after, device.sends_until);
  device.sends_until = start + character_ * static_cast<std::int64_t>(reaction.response.size());
  transmit(kDevices + static_cast<int>(index), reaction.response, start);
}

void SharedWire::to_masters(int sender, std::uint8_t character, Instant end) {
  for (std::size_t i = 0; i < masters_.size(); ++i) {
    Master& master = *masters_[i];
    const bool own = sender == static_cast<int>(i);
    const bool deaf = master.sends_until >= end && !own;
    if (!master.open || master.cut || deaf || (own && !master.adapter.echo)) continue;
    master.received.push_back(character);
    if (master.deliver_at == kNever) master.deliver_at = end + master.adapter.latency;
  }
}

void SharedWire::feed(std::size_t index, const BusEvent& event) {
  Actions actions;
  BusEngine& engine = masters_[index]->engine;
  engine.on_event(event, now_, actions);
  make_plans(engine, now_, actions);
  for (const Action& action : actions) act(index, action);
  for (const Bytes& bytes : std::exchange(masters_[index]->not_sent, {}))
    feed(index, NotSent{bytes});
}

void SharedWire::act(std::size_t index, const Action& action) {
  Master& master = *masters_[index];
  if (const auto* timer = std::get_if<SetTimer>(&action)) master.timer = std::max(timer->at, now_);
  if (const auto* notice = std::get_if<Notice>(&action)) master.notices.push_back(*notice);
  if (const auto* publish = std::get_if<Publish>(&action)) {
    for (const Sample& sample : publish->samples) {
      if (sample.quality != Quality::kGood) continue;
      ++master.good;
      if (judge && !judge(sample.channel, sample.value)) ++master.wrong;
    }
  }
  if (on_action) on_action(index, action);
  const auto* sent = std::get_if<Send>(&action);
  if (sent == nullptr) return;
  if (may_send && !may_send(index)) {
    master.not_sent.push_back(sent->bytes);
    return;
  }
  ++master.frames;
  master.last_frame = now_;
  if (master.first_frame == kNever) master.first_frame = now_;
  master.sends_until = now_ + character_ * static_cast<std::int64_t>(sent->bytes.size());
  if (master.cut) return;
  note_turn(index, now_);
  transmit(static_cast<int>(index), sent->bytes, now_);
}

}  // namespace fieldcast::test
