// Which store a command opens: that of a configuration file, or the one named.
#pragma once

#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "bridge/base/command_line.hpp"
#include "bridge/store/sql.hpp"
#include "core/base/time.hpp"

namespace fieldcast::cli {

struct StoreSource {
  std::string config;  // its `store:` section
  std::string store;   // a file or a connection string; goes before the configuration's
};

// --config and --store.
void add_store(CommandLine& line, StoreSource& source);

// The fault is for people.
[[nodiscard]] tl::expected<StoreAddress, std::string> resolve(const StoreSource& source);

struct TimeSpan {
  UtcTime from, to;
};

}  // namespace fieldcast::cli
