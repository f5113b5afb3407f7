// A device that is leased to an engineer, for display. Plain values.
#pragma once

#include <string>

namespace fieldcast::program {

struct LeasedDevice {
  std::string number;
  std::string bus, device;  // names; a module without a bus: "dial-in" and its number
  std::string who;          // the user and the address, or the address alone
};

}  // namespace fieldcast::program
