// Shared by the DDS tests: a domain per process, a bus to publish, and waits with a deadline.
#pragma once

#include <unistd.h>

#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "bridge/dds/endpoints/dds_link.hpp"
#include "bridge/station/station.hpp"
#include "tests/bridge/support/claimed_domain.hpp"

namespace fieldcast::testing {

// Each test process claims its own domain, so parallel processes do not interfere.
inline DdsSpec loopback() {
  static const test::ClaimedDomain domain;
  DdsSpec spec;
  spec.domain = domain.number();
  return spec;
}

inline std::string bus_name(const std::string& stem) {
  return stem + "-" + std::to_string(getpid());
}

inline UtcMapping both_clocks() {
  const auto steady = std::chrono::steady_clock::now().time_since_epoch();
  const auto utc = std::chrono::system_clock::now().time_since_epoch();
  return {Instant{steady}, {std::chrono::duration_cast<std::chrono::nanoseconds>(utc).count()}};
}

// Returns true as soon as the condition is true, false after 10 s.
inline bool eventually(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{10};
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds{2});
  }
  return true;
}

// Returns one device "d" with channels "c0", "c1", ...; `refresh` maps their number.
inline BusSpec bus_of(const std::string& name, std::size_t channels,
                      const std::function<Duration(std::size_t)>& refresh) {
  BusSpec bus;
  bus.name = name;
  DeviceSpec& device = bus.devices.emplace_back();
  device.name = "d";
  for (std::size_t i = 0; i < channels; ++i) {
    ChannelSpec& channel = device.channels.emplace_back();
    channel.name = "c" + std::to_string(i);
    channel.at = "holding:" + std::to_string(i);
    channel.refresh = refresh(i);
  }
  return bus;
}
inline BusSpec bus_of(const std::string& name, std::size_t channels) {
  return bus_of(name, channels, [](std::size_t) { return Duration{std::chrono::seconds{10}}; });
}

inline Sample good(ChannelIndex channel, Value value, std::uint64_t sequence = 1) {
  Sample sample;
  sample.channel = channel;
  sample.value = std::move(value);
  sample.quality = Quality::kGood;
  sample.acquired = both_clocks().instant;
  sample.sequence = sequence;
  return sample;
}

template <class T>
class Collected {
 public:
  void add(T item) {
    const std::lock_guard lock(mutex_);
    items_.push_back(std::move(item));
  }
  void clear() {
    const std::lock_guard lock(mutex_);
    items_.clear();
  }
  [[nodiscard]] std::vector<T> all() const {
    const std::lock_guard lock(mutex_);
    return items_;
  }
  [[nodiscard]] std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return items_.size();
  }

 private:
  mutable std::mutex mutex_;
  std::vector<T> items_;
};

inline DdsLink::BridgeHandlers unheard() {
  return {.found = [](const std::string&) {},
          .received = [](const std::string&, const BridgeClaims&) {},
          .alive = [](const std::string&, bool) {},
          .lost = [](const std::string&) {}};
}

struct Received {
  Collected<std::pair<std::string, Command>> commands;
  Collected<Interest> interests;
  Collected<AlarmAction> actions;
  Collected<std::string> problems;
  std::function<void(const std::string& bus, const Command& command)> answer;
  std::function<void(const AlarmAction& action)> answer_action;

  DdsLink::Handlers handlers() {
    return {.clock = both_clocks,
            .on_command =
                [this](const std::string& bus, Command command, std::string) {
                  commands.add({bus, command});
                  if (answer) answer(bus, command);
                },
            .on_interest = [this](Interest interest) { interests.add(std::move(interest)); },
            .on_problem = [this](std::string text) { problems.add(std::move(text)); },
            .bridges = unheard(),
            .on_alarm_action =
                [this](AlarmAction action) {
                  actions.add(action);
                  if (answer_action) answer_action(action);
                }};
  }
};

inline StationCommand write_running(const std::string& bus) {
  StationCommand command;
  command.bus = bus;
  command.command.device = "d";
  command.command.target = ChannelTarget{"c0"};
  command.command.values = {true};
  return command;
}

inline CommandResult done(const Command& command) {
  CommandResult result;
  result.requester = command.requester;
  result.request_id = command.request_id;
  result.state = CommandState::kDone;
  result.values = command.values;
  result.received = result.started = result.completed = both_clocks().instant;
  return result;
}

// Announces which buses a link serves, or waits for as a member of a group.
inline void claim(DdsLink& link, const std::vector<std::string>& buses, bool serving = true,
                  const std::string& group = "") {
  BridgeClaims claims{.bridge = "test", .group = group};
  for (const std::string& bus : buses) claims.buses[bus] = {.since = {1}, .serving = serving};
  link.announce(claims);
}

struct Obedient {
  explicit Obedient(const std::string& bus, std::size_t channels = 1,
                    const DdsSpec& spec = loopback())
      : link(spec, "test", received.handlers()) {
    received.answer = [this](const std::string& name, const Command& command) {
      link.complete(name, done(command), both_clocks());
    };
    link.add_bus(bus_of(bus, channels));
    claim({bus});
  }
  void claim(const std::vector<std::string>& buses, bool serving = true,
             const std::string& group = "") {
    testing::claim(link, buses, serving, group);
  }
  Received received;
  DdsLink link;
};

}  // namespace fieldcast::testing
