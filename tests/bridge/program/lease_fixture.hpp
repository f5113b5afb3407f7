// A programming server with one bus that it can lease.
//
// Owns the bus's runner, its thread and its reports. Functions run on the thread of the test. Waits
// return false after the limit of RecordingSink.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "bridge/base/io_thread.hpp"
#include "bridge/bus/bus_runner.hpp"
#include "tests/bridge/program/program_support.hpp"
#include "tests/bridge/support/recording_sink.hpp"

namespace fieldcast::test {

inline BusSpec bus_of(const PortSpec& port) {
  BusSpec bus;
  bus.name = "line";
  bus.port = port;
  DeviceSpec device;
  device.name = "plc";
  device.protocol = "modbus-rtu";
  device.timeout = std::chrono::milliseconds{200};
  device.number = "P1";
  ChannelSpec channel;
  channel.name = "r5";
  channel.at = "holding:5";
  channel.range = {2, 5, 1};
  channel.refresh = std::chrono::milliseconds{50};
  channel.access = Access::kReadWrite;
  device.channels.push_back(channel);
  bus.devices.push_back(device);
  return bus;
}

struct LeaseFixture : ServerFixture {
  void run(const BusSpec& bus) {
    runner = std::make_shared<BusRunner>(io, io.context(), bus, sink, &modules);
    runner->start();
    server.add_bus(bus, runner);
    name = bus.name;
  }
  void end_bus() {
    if (!runner) return;
    server.remove_bus(name);
    runner->stop().wait();
    runner.reset();
  }
  ~LeaseFixture() override { end_bus(); }
  std::size_t good() {
    const auto record = sink.record();
    return static_cast<std::size_t>(
        std::count_if(record.samples.begin(), record.samples.end(),
                      [](const Sample& s) { return s.quality == Quality::kGood; }));
  }
  [[nodiscard]] bool receives_more() {
    const std::size_t before = good();
    return sink.wait_for([&](const auto& r) {
      return static_cast<std::size_t>(std::count_if(
                 r.samples.begin(), r.samples.end(),
                 [](const Sample& s) { return s.quality == Quality::kGood; })) >= before + 3;
    });
  }
  [[nodiscard]] bool leased() {
    return sink.wait_for([](const auto& r) {
      return !r.samples.empty() && r.samples.back().quality == Quality::kUncertain;
    });
  }

  IoThread io{"test"};
  RecordingSink sink;
  std::shared_ptr<BusRunner> runner;
  std::string name;
};

}  // namespace fieldcast::test
