// Where a command looks for bridges: the DDS domain of a bridge's or a station's configuration
// file, the sites of a station's, or the domain of --domain and --interface.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/base/command_line.hpp"
#include "core/base/time.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::cli {

// Until a bridge must have shown itself.
inline constexpr Duration kBridgeWait = std::chrono::seconds{5};
// When nothing new came for so long, everything that is there is known.
inline constexpr Duration kQuietTime = std::chrono::milliseconds{700};
// The same before a bus is called unknown: another bridge may have it, which shows itself later.
inline constexpr Duration kOtherBridges = std::chrono::seconds{2};

struct ConnectionOptions {
  std::string config;                   // its `dds:` section; empty: none
  std::optional<std::uint32_t> domain;  // goes before the file's
  std::vector<std::string> interfaces;  // goes before the file's
  std::string security;                 // a member's folder; goes before the file's; empty: none
};

// --config, --domain, --interface and --security.
void add_connection(CommandLine& line, ConnectionOptions& options);

// The domain that a command joins, or those of several sites.
struct Connection {
  Connection(DdsSpec spec) : sites{DdsSite{{}, std::move(spec)}} {}
  Connection(std::vector<DdsSite> given) : sites(std::move(given)) {}

  std::vector<DdsSite> sites;  // one at least
};

// The fault is for people: every fault of the file or of the member's folder, one on each line.
[[nodiscard]] tl::expected<Connection, std::string> resolve(const ConnectionOptions& options);

// "; plant press may command press-* only", if that is why a command to the bus has no result.
[[nodiscard]] std::string held_remark(const Connection& connection, std::string_view bus);

// Why a command was not sent: no bridge of the bus was found within kBridgeWait.
[[nodiscard]] std::string not_served_text(const Connection& connection, std::string_view bus);

// "DDS domain 0 on 127.0.0.1", "the sites north, south"
[[nodiscard]] std::string domain_text(const Connection& connection);

// Nobody was found there: what that means and what to look at.
// `missing`: discovery servers that do not answer.
[[nodiscard]] std::string no_bridge_text(const Connection& connection,
                                         const std::vector<std::string>& missing);

}  // namespace fieldcast::cli
