// Where a command looks for bridges: the DDS domain of a configuration file, the sites of a
// station's, or --domain and --interface.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/process/command_line.hpp"
#include "bridge/store/sql/sql.hpp"
#include "core/base/time.hpp"
#include "core/model/dds_spec.hpp"

namespace fieldcast::cli {

// Time for a bridge to be discovered.
inline constexpr Duration kBridgeWait = std::chrono::seconds{5};
// If nothing new arrives for this time, everything is known.
inline constexpr Duration kQuietTime = std::chrono::milliseconds{700};
// Longer, because a second bridge may be discovered later.
inline constexpr Duration kOtherBridges = std::chrono::seconds{2};

struct ConnectionOptions {
  std::string config;                   // path; its `dds:` section is used; empty: none
  std::optional<std::uint32_t> domain;  // overrides the file
  std::vector<std::string> interfaces;  // overrides the file
  std::string security;                 // directory of a member; overrides the file; empty: none
};

void add_connection(CommandLine& line, ConnectionOptions& options);

struct Connection {
  Connection(DdsSpec spec) : sites{DdsSite{{}, std::move(spec)}} {}
  Connection(std::vector<DdsSite> given) : sites(std::move(given)) {}

  std::vector<DdsSite> sites;  // at least one
};

[[nodiscard]] tl::expected<Connection, std::string> resolve(const ConnectionOptions& options);

// "; plant press may command press-* only", if this explains a missing result.
[[nodiscard]] std::string held_remark(const Connection& connection, std::string_view bus);

// For a command: no bridge of the bus was found within kBridgeWait.
[[nodiscard]] std::string not_served_text(const Connection& connection, std::string_view bus);

// For a command that was sent, but has no result within `limit`.
[[nodiscard]] std::string no_result_text(const Connection& connection, std::string_view bus,
                                         Duration limit);

[[nodiscard]] std::string domain_text(const Connection& connection);

// `missing`: discovery servers that do not respond.
[[nodiscard]] std::string no_bridge_text(const Connection& connection,
                                         const std::vector<std::string>& missing);

struct StoreSource {
  std::string config;  // its `store:` section is used
  std::string store;   // a file or a connection string; overrides the configuration
};

void add_store(CommandLine& line, StoreSource& source);

[[nodiscard]] tl::expected<StoreAddress, std::string> resolve(const StoreSource& source);

struct TimeSpan {
  UtcTime from, to;
};

}  // namespace fieldcast::cli
