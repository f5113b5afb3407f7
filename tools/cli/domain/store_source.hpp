#pragma once

#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "bridge/base/command_line.hpp"
#include "bridge/store/sql/sql.hpp"
#include "core/base/time.hpp"

namespace fieldcast::cli {

struct StoreSource {
  std::string config;  // its `store:` section is used
  std::string store;   // a file or a connection string; overrides the configuration
};

void add_store(CommandLine& line, StoreSource& source);

// The error is human-readable.
[[nodiscard]] tl::expected<StoreAddress, std::string> resolve(const StoreSource& source);

struct TimeSpan {
  UtcTime from, to;
};

}  // namespace fieldcast::cli
