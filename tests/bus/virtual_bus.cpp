#include "tests/bus/virtual_bus.hpp"

#include <gtest/gtest.h>

namespace fieldcast::test {

VirtualBus::VirtualBus(const BusSpec& spec, const sim::BusFaults& faults, std::uint64_t seed)
    : spec_(spec), engine_(spec), character_(line_of(spec.port).characters(1)) {
  auto plant = sim::SimBus::make(spec, faults, seed, now_);
  if (!plant) throw std::runtime_error(plant.error());
  plant_ = std::move(*plant);
  line_ = plant_->open_line();
  std::size_t count = 0;
  for (const DeviceSpec& device : spec.devices) count += device.channels.size();
  watched_.resize(count);
  feed(Opened{});
}

void VirtualBus::run_until(Instant until) {
  while (true) {
    const Instant due = std::min(timer_, plugged_ ? line_->next_due() : kNever);
    if (due > until) break;
    now_ = std::max(now_, due);
    if (plugged_ && line_->next_due() <= now_) {
      Bytes heard;
      line_->advance(now_, heard);
      if (!heard.empty()) feed(Received{heard});
    }
    if (timer_ <= now_) {
      timer_ = kNever;
      feed(TimerFired{});
    }
  }
  now_ = until;
}

void VirtualBus::command(Command command) {
  command.requester = "test";
  command.request_id = ++commands_;
  feed(CommandArrived{std::move(command)});
}

void VirtualBus::unplug() {
  plugged_ = false;
  line_.reset();
  feed(Closed{"unplugged"});
}

void VirtualBus::plug() {
  plugged_ = true;
  line_ = plant_->open_line();
  feed(Opened{});
}

void VirtualBus::stop() { feed(StopRequested{}); }

void VirtualBus::watch_from_now() {
  for (Watched& channel : watched_) {
    channel.good = channel.bad = 0;
    channel.longest_gap = Duration::zero();
    channel.last_good = now_;
  }
}

void VirtualBus::feed(const BusEvent& event) {
  Actions actions;
  engine_.on_event(event, now_, actions);
  for (const Action& action : actions) act(action);
}

void VirtualBus::stamp(std::uint64_t what) { fingerprint_ = (fingerprint_ ^ what) * 1099511628211u; }

void VirtualBus::act(const Action& action) {
  struct Execute {
    VirtualBus& bus;
    void operator()(const Send& a) const {
      EXPECT_TRUE(bus.plugged_) << "sent into a closed port";
      EXPECT_GE(bus.now_, bus.wire_free_) << "a request was sent into the one before";
      EXPECT_FALSE(a.bytes.empty());
      ++bus.sends_;
      bus.wire_free_ = bus.now_ + bus.character_ * static_cast<std::int64_t>(a.bytes.size());
      if (bus.plugged_) bus.line_->receive(a.bytes, bus.now_);
      bus.stamp(static_cast<std::uint64_t>(bus.now_.time_since_epoch().count()));
      for (const std::uint8_t byte : a.bytes) bus.stamp(byte);
    }
    void operator()(const SetTimer& a) const {
      EXPECT_GE(a.at, bus.now_) << "a timer in the past would spin";
      bus.timer_ = std::max(a.at, bus.now_);
    }
    void operator()(const Publish& a) const {
      EXPECT_FALSE(a.samples.empty());
      for (const Sample& sample : a.samples) publish(sample);
    }
    void publish(const Sample& sample) const {
      Watched& channel = bus.watched_[sample.channel];
      channel.quality = sample.quality;
      bus.stamp(sample.sequence);
      if (sample.quality != Quality::kGood) {
        ++channel.bad;
        return;
      }
      EXPECT_LE(sample.acquired, bus.now_);
      // Noise around an answer is waited out before the answer is found in it.
      EXPECT_LE(bus.now_ - sample.acquired, std::chrono::milliseconds{100})
          << "a good sample that is not fresh, channel " << sample.channel;
      channel.value = sample.value;
      channel.longest_gap = std::max(channel.longest_gap, bus.now_ - channel.last_good);
      channel.last_good = bus.now_;
      ++channel.good;
      if (bus.judge) {
        const std::string wrong = bus.judge(sample.channel, sample.value);
        EXPECT_EQ(wrong, "") << "at " << to_text(bus.now_ - Instant{});
      }
    }
    void operator()(const Promise&) const {}
    void operator()(const Complete& a) const {
      auto& results = bus.results_[a.result.request_id];
      results.push_back(a.result);
      EXPECT_EQ(results.size(), 1u) << "a second result for command " << a.result.request_id;
    }
    void operator()(const Reopen&) const {}
    void operator()(const Notice& a) const { bus.notices_.push_back(a); }
    void operator()(const Traced&) const {}
  };
  std::visit(Execute{*this}, action);
}

}  // namespace fieldcast::test
