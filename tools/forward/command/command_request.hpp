// A request of the centre to write one channel, as JSON, and its response. Pure.
//
// {"schema":1,"id":"8c1f","channel":"line/press/setpoint","value":21.5,"verify":true,
//  "expires_at":1764360005000000000}
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "core/base/time.hpp"
#include "core/base/value.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast::forward {

// Which user may write which channels.
struct CommandRule {
  std::string user;  // "*": every user
  std::vector<Pattern> channels;
};

struct CommandRequest {
  std::string user;  // verified by the permissions of the engine
  std::string id;    // 1 to 64 letters, digits, '-', '_', '.'; unique for the user
  ChannelPath channel;
  Value value;
  bool verify = false;   // read back after the write
  UtcTime expires_at{};  // latest start, by the clock of the site
};

// `id` is empty if the request has none.
struct CommandFault {
  std::string id;
  std::string reason;  // one human-readable line
};

// A request of more bytes is refused, and one that expires later than this after `now`.
inline constexpr std::size_t kMaxCommandBytes = 4096;
inline constexpr Duration kMaxCommandLife = std::chrono::minutes{1};

// Checks form, life span and rights. `user` is 1 to 64 letters, digits, '-', '_', '.', '@'.
[[nodiscard]] tl::expected<CommandRequest, CommandFault> command_request_from(
    std::string_view text, std::string_view user, const std::vector<CommandRule>& rules,
    UtcTime now);

struct CommandResponse {
  std::string id;
  // "done", "verified", "rejected", "failed", "expired", or "unknown": the write may have been done
  std::string state;
  std::string cause;          // as in fieldcast/CommandResult
  std::string reason;         // one human-readable line; empty on success
  std::vector<Value> values;  // read back
  UtcTime completed_at{};
};
[[nodiscard]] std::string to_json(const CommandResponse& response);
// A request that was not passed to a bridge.
[[nodiscard]] CommandResponse refusal(std::string id, std::string reason);

}  // namespace fieldcast::forward
