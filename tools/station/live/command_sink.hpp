// Where commands of people go, and what comes back. An interface: the real one is the command desk.
// All calls both ways on the io thread.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/dds/topics/topic_values.hpp"
#include "tools/station/live/client_message.hpp"
#include "tools/station/web/http_message.hpp"

namespace fieldcast::web {

// What became of a command.
struct CommandOutcome {
  std::uint64_t request_id = 0;
  std::string user;
  std::string target;  // "bus/device/channel"
  // Of a result: "done", "verified", "rejected", "failed", "expired". "not-sent": no bridge has
  // taken it. "no-answer": it was sent, and nobody knows what became of it.
  std::string state;
  std::string cause;  // "NONE", "READ_ONLY", ...
  std::string reason;
  std::vector<Value> values;  // acquired or read back
  UtcTime completed_at;
};
// {"request_id", "target", "state", "cause", "reason", "value", "completed_ms"}, and "values" where
// there are several. The value is null where there is none.
[[nodiscard]] std::string outcome_json(const CommandOutcome& outcome);

class CommandSink {
 public:
  virtual ~CommandSink() = default;
  // The request_id: `done` is called once, later. Requester, request_id and times are filled in.
  [[nodiscard]] virtual tl::expected<std::uint64_t, Refusal> submit(
      const Caller& caller, StationCommand command,
      std::function<void(const CommandOutcome&)> done) = 0;
};

// The command that writes one value to a channel, or reads it now.
[[nodiscard]] StationCommand write_command(const ChannelPath& path, Value value, bool verify);
[[nodiscard]] StationCommand acquire_command(const ChannelPath& path);

}  // namespace fieldcast::web
