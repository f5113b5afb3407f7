#pragma once

#include <cstdint>
#include <string>

#include "tools/cli/command/base/command_options.hpp"

namespace fieldcast::cli {

struct AcquireOptions : CommandOptions {
  std::string target;       // BUS/DEVICE or BUS/DEVICE/CHANNEL
  std::uint32_t count = 1;  // values at the address
};

}  // namespace fieldcast::cli
