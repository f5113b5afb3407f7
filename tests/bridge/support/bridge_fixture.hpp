// Shared by tests of the whole bridge: two buses on pseudo-terminals, and a station that receives
// them over DDS.
//
// BridgeTest owns the terminals and its own DDS domain. A Receiver gets samples on DDS threads; its
// functions are for the thread of the test. Waits return false after their limit.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "bridge/bridge.hpp"
#include "bridge/station/station.hpp"
#include "tests/bridge/support/claimed_domain.hpp"
#include "tests/bridge/support/pty.hpp"

namespace fieldcast::test {

inline BusSpec bus_at(const std::string& name, const std::string& path) {
  BusSpec bus;
  bus.name = name;
  SerialPortSpec port;
  port.path = path;
  port.line = {115200, 8, Parity::kNone, 1};
  bus.port = port;
  DeviceSpec device;
  device.name = "plc";
  device.protocol = "modbus-rtu";
  device.timeout = std::chrono::milliseconds{100};
  for (std::uint32_t i = 0; i < 3; ++i) {
    ChannelSpec channel;
    channel.name = "r" + std::to_string(i);
    channel.at = "holding:" + std::to_string(i);
    channel.range = {2, i, 1};
    channel.refresh = std::chrono::milliseconds{100};
    channel.access = Access::kReadWrite;
    device.channels.push_back(channel);
  }
  bus.devices.push_back(device);
  return bus;
}

// Reports of one kind that a station receives, with waits. Any thread.
template <typename Report>
class Reports {
 public:
  void add(const Report& report) {
    {
      const std::lock_guard lock(mutex_);
      reports_.push_back(report);
    }
    changed_.notify_all();
  }
  // Waits until the newest report satisfies `wanted`; false after the limit.
  [[nodiscard]] bool newest(const std::function<bool(const Report&)>& wanted) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds{15},
                             [&] { return !reports_.empty() && wanted(reports_.back()); });
  }
  [[nodiscard]] Report last() {  // REQUIRES: there is one
    const std::lock_guard lock(mutex_);
    return reports_.back();
  }
  void forget() {
    const std::lock_guard lock(mutex_);
    reports_.clear();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Report> reports_;
};

class Receiver {
 public:
  explicit Receiver(const DdsSpec& dds) : station(dds, "receiver") {
    station.subscribe_samples([this](const StationSample& sample) {
      {
        const std::lock_guard lock(mutex_);
        samples_.push_back(sample);
      }
      changed_.notify_all();
    });
  }
  [[nodiscard]] bool receives(const std::function<bool(const StationSample&)>& wanted,
                              std::chrono::milliseconds limit = std::chrono::seconds{15}) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, limit,
                             [&] { return std::any_of(samples_.begin(), samples_.end(), wanted); });
  }
  void forget() {
    const std::lock_guard lock(mutex_);
    samples_.clear();
  }
  [[nodiscard]] std::vector<StationSample> samples() {
    const std::lock_guard lock(mutex_);
    return samples_;
  }
  Station station;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<StationSample> samples_;
};

inline std::function<bool(const StationSample&)> good_from(const std::string& bus) {
  return [bus](const StationSample& sample) {
    return sample.bus == bus && sample.quality == Quality::kGood;
  };
}

inline StationCommand write_to(const std::string& bus, const std::string& channel,
                               std::uint64_t value) {
  StationCommand command;
  command.bus = bus;
  command.command.device = "plc";
  command.command.target = ChannelTarget{channel};
  command.command.values = {Value{value}};
  return command;
}

struct BridgeTest : testing::Test {
  BridgeTest() {
    spec.name = "line";
    spec.dds.domain = domain.number();
    spec.buses = {bus_at("one", first.path()), bus_at("two", second.path())};
  }

  ClaimedDomain domain;
  BridgeSpec spec;
  Pty first, second;
};

}  // namespace fieldcast::test
