#include "core/model/command.hpp"

namespace fieldcast {

CommandResult refusal(const Command& command, CommandState state, Cause cause, std::string reason,
                      Instant received, Instant now) {
  CommandResult result;
  result.requester = command.requester;
  result.request_id = command.request_id;
  result.state = state;
  result.cause = cause;
  result.reason = std::move(reason);
  result.received = received;
  result.started = result.completed = now;
  result.gateway = command.gateway;
  result.gateway_read = command.is_gateway_read();
  result.ad_hoc = command.ad_hoc != nullptr;
  return result;
}

CommandResult rejection(const Command& command, Cause cause, std::string reason, Instant now) {
  return refusal(command, CommandState::kRejected, cause, std::move(reason), now, now);
}

}  // namespace fieldcast
