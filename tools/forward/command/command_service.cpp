#include "tools/forward/command/command_service.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"

namespace fieldcast::forward {

namespace {

constexpr const char* kSubject = "command";
// Of one command at the bridge, so that the forwarder can stop in time.
constexpr Duration kLongest = std::chrono::seconds{5};

// The identity of the request is that of the journal, not of this text.
std::string unknown_text() {
  return to_json({.state = "unknown",
                  .cause = "NONE",
                  .reason = "the forwarder ended while the command ran: read the channel"});
}

CommandResponse response_from(const std::string& id, const StationOutcome& outcome) {
  if (outcome)
    return {.id = id,
            .state = std::string(to_text(outcome->state)),
            .cause = outcome->cause,
            .reason = outcome->reason,
            .values = outcome->values,
            .completed_at = outcome->completed_at};
  const bool is_unknown = outcome.error() == StationFault::kNoResult;
  return {.id = id,
          .state = is_unknown ? "unknown" : "rejected",
          .cause = "NONE",
          .reason = to_text(outcome)};
}

void log_fault(const StoreError& error) {
  log_counted(LogLevel::kError, kSubject, "faults of the journal", error.what());
}

}  // namespace

CommandService::CommandService(CommandSpec spec, const std::string& journal, Execute execute)
    : spec_(std::move(spec)),
      execute_(std::move(execute)),
      journal_(journal, unknown_text()),
      worker_("commands", kMaxWaiting,
              [this](BoundedQueue<CentreRequest>& requests) { run(requests); }) {}

void CommandService::on_request(CentreRequest request) {
  if (!worker_.queue().try_put(request)) refuse(request);
}

void CommandService::refuse(const CentreRequest& request) const {
  request.reply(to_json(refusal("", "this site accepts no further command now: repeat it later")));
}

void CommandService::run(BoundedQueue<CentreRequest>& requests) {
  while (const auto request = requests.take()) {
    if (requests.closed()) {
      refuse(*request);
      continue;
    }
    try {
      request->reply(response_to(*request));
    } catch (const StoreError& error) {
      log_fault(error);
      request->reply(to_json(refusal("", "the site cannot store the command")));
    }
  }
}

std::string CommandService::response_to(const CentreRequest& request) {
  const UtcTime now = read_clocks().utc;
  const auto command = command_request_from(request.text, request.user, spec_.rules, now);
  if (!command) {
    const CommandFault& fault = command.error();
    // A repeated request may have expired meanwhile.
    if (const auto known = journal_.response(request.user, fault.id)) return *known;
    log_counted(LogLevel::kWarning, kSubject, "refused commands",
                fmt::format("{}: {}", request.user, fault.reason));
    return to_json(refusal(fault.id, fault.reason));
  }
  const CommandJournal::Entry entry = journal_.begin(command->user, command->id, now);
  if (entry.response) return *entry.response;
  if (!entry.is_new)
    return to_json({.id = command->id,
                    .state = "unknown",
                    .cause = "NONE",
                    .reason = "the site could not store the first result: read the channel"});
  const Duration left = std::min(
      kLongest, Duration{saturated_difference(command->expires_at.nanoseconds, now.nanoseconds)});
  // In whole seconds if possible, because each lifespan has a DDS writer of its own.
  const Duration seconds = std::chrono::floor<std::chrono::seconds>(left);
  const Duration lifespan = seconds > Duration{} ? seconds : left;
  log_info(kSubject, fmt::format("{}: {} of {} by {}", command->id, to_text(command->action),
                                 command->channel.text(), command->user));
  const std::string response = to_json(response_from(command->id, execute_(*command, lifespan)));
  try {
    journal_.complete(command->user, command->id, response);
  } catch (const StoreError& error) {
    log_fault(error);  // the command was executed
  }
  return response;
}

}  // namespace fieldcast::forward
