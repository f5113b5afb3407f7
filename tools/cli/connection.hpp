// Where a command looks for bridges: the DDS domain of a configuration file, or that of --domain
// and --interface.
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

struct ConnectionOptions {
  std::string config;                   // its `dds:` section; empty: none
  std::optional<std::uint32_t> domain;  // goes before the file's
  std::vector<std::string> interfaces;  // goes before the file's
  std::string security;                 // a member's folder; goes before the file's; empty: none
};

// --config, --domain, --interface and --security.
void add_connection(CommandLine& line, ConnectionOptions& options);

// The fault is for people: every fault of the file or of the member's folder, one on each line.
// "; plant press may command press-* only", if that is why a command to the bus has no result.
[[nodiscard]] std::string held_remark(const DdsSpec& spec, std::string_view bus);

[[nodiscard]] tl::expected<DdsSpec, std::string> resolve(const ConnectionOptions& options);

// "DDS domain 0 on 127.0.0.1"
[[nodiscard]] std::string domain_text(const DdsSpec& spec);

// Nobody was found there: what that means and what to look at.
[[nodiscard]] std::string no_bridge_text(const DdsSpec& spec);

}  // namespace fieldcast::cli
