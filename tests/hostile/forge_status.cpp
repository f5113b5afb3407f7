// Writes forged fieldcast/BusStatus and fieldcast/DeviceStatus messages until it is ended, for
// forged_status.py: the bus runs, and each TEXT is a name of a cause and of a device.
//
//   forge-status DOMAIN BUS TEXT...
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <thread>

#include "bridge/dds/topics/topics.hpp"
#include "bridge/dds/transport/domain.hpp"

int main(int argc, char** argv) {
  using namespace fieldcast;
  if (argc < 4) {
    std::fprintf(stderr, "usage: forge-status DOMAIN BUS TEXT...\n");
    return 2;
  }
  const std::span<char*> texts(argv + 3, argv + argc);
  DdsSpec spec;
  spec.domain = static_cast<std::uint32_t>(std::atoi(argv[1]));
  spec.interfaces = {"127.0.0.1"};
  Domain domain(spec, "forger", nullptr);
  auto* const buses = domain.writer(kBusStatusTopic, "forger");
  auto* const devices = domain.writer(kDeviceStatusTopic, "forger");
  idl::CauseCounts causes;
  for (const char* text : texts) {
    causes.emplace_back().cause(text);
    causes.back().count(7);
  }
  for (;;) {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    idl::BusStatus bus;
    bus.bus(argv[2]);
    bus.bridge("honest");
    bus.state(idl::BusState::BUS_RUNNING);
    bus.causes(causes);
    bus.misses(causes);
    bus.reported_at(std::chrono::nanoseconds(now).count());
    buses->write(&bus);
    for (const char* text : texts) {
      idl::DeviceStatus device;
      device.bus(argv[2]);
      device.device(text);
      device.state(idl::DeviceState::DEVICE_ONLINE);
      device.causes(causes);
      device.reported_at(std::chrono::nanoseconds(now).count());
      devices->write(&device);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds{100});
  }
}
