#pragma once

#include <optional>

#include "core/base/time.hpp"
#include "tools/cli/domain/connection.hpp"

namespace fieldcast::cli {

struct StatusOptions {
  ConnectionOptions connection;
  bool json = false;
  bool once = false, plain = false;  // text, also in a terminal
  // Empty to print once, or to show the screen until the user quits.
  std::optional<Duration> time;
};

}  // namespace fieldcast::cli
