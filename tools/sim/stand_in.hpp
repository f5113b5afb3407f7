// Stands in for devices that nobody has written yet: exchanges of the right length, with nothing in them.
//
// A bus in virtual time needs of an exchange how long it takes. Where no simulated device speaks a protocol (declared ones), its
// devices are given one that sends as many characters as the protocol says (Protocol::size), in as many rounds, and an answer of
// zeros; faults of the line and of devices happen to it all the same. What is inside frames is not simulated then. Pure.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "core/protocol/protocol.hpp"
#include "tools/sim/device.hpp"

namespace fieldcast::sim {

// What both ends of a stood-in device know of the round under way.
struct StandInRound {
  std::uint32_t request = 0, answer = 0;  // characters
  std::uint32_t heard = 0;
  bool open = false;
};

// Makes both ends for the devices of one bus; outlives them.
class StandIns {
 public:
  // True when the device's protocol has no simulated devices.
  [[nodiscard]] static bool needed(const DeviceSpec& device);

  // The protocol for the engine: the real one, or its stand-in. REQUIRES: the device is as the loader makes it.
  [[nodiscard]] std::unique_ptr<Protocol> protocol(const DeviceSpec& device, const LineFormat& line);
  [[nodiscard]] std::unique_ptr<SimDevice> device(const DeviceSetup& setup);

 private:
  std::map<std::string, std::shared_ptr<StandInRound>> rounds_;  // by device
};

}  // namespace fieldcast::sim
