// A request of the centre for one channel or its alarm, as JSON, and its response. Pure.
//
// {"schema":1,"id":"8c1f","channel":"line/press/setpoint","value":21.5,"verify":true,
//  "expires_at":1764360005000000000}
// {"schema":1,"id":"8c20","action":"acknowledge","channel":"line/press/temperature",
//  "limit":"high","note":"seen","expires_at":1764360005000000000}
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "core/alarm/alarm_status.hpp"
#include "core/base/time.hpp"
#include "core/base/value.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast::forward {

// Which user may command which channels.
struct CommandRule {
  std::string user;  // "*": every user
  std::vector<Pattern> channels;
};

enum class CentreAction : std::uint8_t { kWrite, kAcquire, kAcknowledge, kShelve, kUnshelve };

[[nodiscard]] std::string_view to_text(CentreAction action);  // "write", ...
// Empty for kWrite and kAcquire.
[[nodiscard]] std::optional<AlarmActionKind> alarm_action_of(CentreAction action);

struct CommandRequest {
  std::string user;  // verified by the permissions of the engine
  std::string id;    // 1 to 64 letters, digits, '-', '_', '.'; unique for the user
  CentreAction action = CentreAction::kWrite;
  ChannelPath channel;
  Value value;                         // kWrite
  bool verify = false;                 // kWrite: read back after the write
  LimitKind limit = LimitKind::kHigh;  // of the alarm
  std::string note;                    // of an action on an alarm
  UtcTime raised_at{};                 // kAcknowledge: the occurrence; 0: any
  std::uint32_t minutes = 0;           // kShelve
  UtcTime expires_at{};                // latest start, by the clock of the site
};
// The text that command_request_from() parses; the user is not in it.
[[nodiscard]] std::string to_json(const CommandRequest& request);

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

// Longest wait for the bridge of a command, and the life span that remains when it was found.
struct CommandTimes {
  Duration finding, lifespan;
};
// `lifespan`: latest start from now. In whole seconds if possible, because each lifespan has a DDS
// writer of its own.
[[nodiscard]] CommandTimes times_within(Duration lifespan);

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
// Parses the response of a site. Untrusted; empty if it is not one of this version.
[[nodiscard]] std::optional<CommandResponse> command_response_from(std::string_view text);
// A request that was not passed to a bridge.
[[nodiscard]] CommandResponse refusal(std::string id, std::string reason);

}  // namespace fieldcast::forward
