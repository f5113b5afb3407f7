// The COM ports of this computer.
#pragma once

#include <string>
#include <vector>

namespace fieldcast::port {

struct ComPort {
  std::string name;    // "COM5"
  std::string device;  // "\Device\com0com10"
};

// As the drivers have registered them (HKLM\HARDWARE\DEVICEMAP\SERIALCOMM), by number.
[[nodiscard]] std::vector<ComPort> com_ports();

}  // namespace fieldcast::port
