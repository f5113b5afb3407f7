#include "tests/bus/virtual_bus.hpp"

#include <gtest/gtest.h>

namespace fieldcast::test {

namespace {
std::size_t channels_of(const BusSpec& spec) {
  std::size_t count = 0;
  for (const DeviceSpec& device : spec.devices) count += device.channels.size();
  return count;
}
}  // namespace

VirtualBus::VirtualBus(const BusSpec& spec, const sim::BusFaults& faults, std::uint64_t seed)
    : watched_(channels_of(spec)),
      bus_(spec, faults, seed, [this](const Action& action) { see(action); }) {}

void VirtualBus::run_until(Instant until) { bus_.run_until(until); }

void VirtualBus::command(Command command) {
  if (command.requester.empty()) command.requester = "test";
  command.request_id = ++commands_;
  bus_.feed(CommandArrived{std::move(command)});
}

void VirtualBus::unplug() { bus_.unplug(); }

void VirtualBus::plug() { bus_.plug(); }

void VirtualBus::stop() { bus_.feed(StopRequested{}); }

void VirtualBus::watch_from_now() {
  for (Watched& channel : watched_) {
    channel.good = channel.bad = 0;
    channel.longest_gap = Duration::zero();
    channel.last_good = now();
  }
}

void VirtualBus::see(const Action& action) {
  struct Execute {
    VirtualBus& bus;
    void operator()(const Send& a) const {
      EXPECT_TRUE(bus.bus_.plugged()) << "sent into a closed port";
      EXPECT_GE(bus.now(), bus.bus_.wire_free()) << "a request was sent into the one before";
      EXPECT_FALSE(a.bytes.empty());
      ++bus.sends_;
    }
    void operator()(const SetTimer& a) const {
      EXPECT_GE(a.at, bus.now()) << "a timer in the past would spin";
    }
    void operator()(const Publish& a) const {
      EXPECT_FALSE(a.samples.empty());
      for (const Sample& sample : a.samples) publish(sample);
    }
    void publish(const Sample& sample) const {
      Watched& channel = bus.watched_[sample.channel];
      channel.quality = sample.quality;
      if (sample.quality != Quality::kGood) {
        ++channel.bad;
        return;
      }
      EXPECT_LE(sample.acquired, bus.now());
      // Noise around a response must end before the response is extracted.
      EXPECT_LE(bus.now() - sample.acquired, std::chrono::milliseconds{100})
          << "a good sample that is not fresh, channel " << sample.channel;
      channel.value = sample.value;
      channel.longest_gap = std::max(channel.longest_gap, bus.now() - channel.last_good);
      channel.last_good = bus.now();
      ++channel.good;
      if (bus.judge) {
        const std::string wrong = bus.judge(sample.channel, sample.value);
        EXPECT_EQ(wrong, "") << "at " << to_text(bus.now() - Instant{});
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
    void operator()(const MakePlan&) const {}
  };
  std::visit(Execute{*this}, action);
}

}  // namespace fieldcast::test
