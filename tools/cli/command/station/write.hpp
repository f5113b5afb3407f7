#pragma once

#include <string>
#include <vector>

#include "tools/cli/command/base/command_options.hpp"

namespace fieldcast::cli {

struct WriteOptions : CommandOptions {
  std::vector<std::string> words;  // BUS/DEVICE/CHANNEL=VALUE ..; with `at`: BUS/DEVICE VALUE ..
  bool verify = false;
};

}  // namespace fieldcast::cli
