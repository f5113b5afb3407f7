#include "bridge/command_desk.hpp"

namespace fieldcast {
namespace {

CommandResult refuse(const Command& command, Cause cause, std::string reason, Instant now) {
  CommandResult result;
  result.requester = command.requester;
  result.request_id = command.request_id;
  result.state = CommandState::kRejected;
  result.cause = cause;
  result.reason = std::move(reason);
  result.received = result.started = result.completed = now;
  return result;
}

}  // namespace

void CommandDesk::add(const std::string& bus, std::shared_ptr<BusRunner> runner) {
  const std::lock_guard lock(mutex_);
  runners_[bus] = std::move(runner);
}

void CommandDesk::remove(const std::string& bus) {
  const std::lock_guard lock(mutex_);
  runners_.erase(bus);
}

std::optional<CommandResult> CommandDesk::take(const std::string& bus, Command command, Instant now) {
  // Posted under the lock: once remove() has returned, nothing more comes to the runner.
  const std::lock_guard lock(mutex_);
  if (!ledger_.enter(command.requester, command.request_id)) {
    return refuse(command, Cause::kDuplicate, "this requester used this request_id before", now);
  }
  const auto found = runners_.find(bus);
  if (found == runners_.end()) return refuse(command, Cause::kShutdown, "the bridge is stopping this bus", now);
  CommandResult full = refuse(command, Cause::kQueueFull, "too many commands wait for this bus", now);
  if (!found->second->post(std::move(command))) return full;
  return std::nullopt;
}

}  // namespace fieldcast
