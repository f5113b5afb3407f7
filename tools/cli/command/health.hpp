// `fieldcast health`: requests the state of a bridge or of a station, for the supervisor of a
// container.
#pragma once

#include <string>

#include "core/base/time.hpp"
#include "tools/cli/command/base/command.hpp"

namespace fieldcast::cli {

struct HealthOptions {
  std::string url;  // "http://127.0.0.1:9464/healthz"
  Duration timeout = std::chrono::seconds{3};
};

// kOk if the response has status 200; kFound for another status, or without a response in time,
// with the reason in `err`.
[[nodiscard]] ExitCode health(const HealthOptions& options, const Streams& to);

}  // namespace fieldcast::cli
