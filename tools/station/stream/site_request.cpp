#include "tools/station/stream/site_request.hpp"

#include <algorithm>
#include <array>

#include "tools/forward/outlet/nats/subject.hpp"

namespace fieldcast::web {

namespace {

using forward::CentreAction;

// An action on an alarm is not run later than this after it was sent.
constexpr Duration kActionLife = std::chrono::seconds{5};

std::optional<SiteRequest> finished(forward::CommandRequest request, const std::string& bus,
                                    const std::string& user, std::string id, UtcTime now,
                                    Duration life) {
  const std::size_t end = bus.find(':');
  if (end == bus.npos) return std::nullopt;
  request.channel.bus = bus.substr(end + 1);
  request.id = std::move(id);
  request.expires_at = {now.nanoseconds + life.count()};
  return SiteRequest{forward::command_subject_of(bus.substr(0, end), user), to_json(request)};
}

std::optional<CentreAction> centre_action_of(AlarmActionKind kind) {
  constexpr std::array kActions{CentreAction::kAcknowledge, CentreAction::kShelve,
                                CentreAction::kUnshelve};
  const auto* const found = std::ranges::find_if(
      kActions, [kind](CentreAction each) { return forward::alarm_action_of(each) == kind; });
  return found == kActions.end() ? std::nullopt : std::optional(*found);
}

std::optional<CommandState> state_from(std::string_view text) {
  for (const auto state : {CommandState::kDone, CommandState::kVerified, CommandState::kRejected,
                           CommandState::kFailed, CommandState::kExpired}) {
    if (to_text(state) == text) return state;
  }
  return std::nullopt;
}

}  // namespace

std::optional<SiteRequest> site_request_of(const StationCommand& command, std::string id,
                                           UtcTime now) {
  const auto* const channel = std::get_if<ChannelTarget>(&command.command.target);
  if (channel == nullptr) return std::nullopt;
  forward::CommandRequest request{
      .channel = {.device = command.command.device, .channel = channel->name}};
  if (command.command.operation == Operation::kAcquire) {
    request.action = CentreAction::kAcquire;
  } else {
    if (command.command.values.size() != 1) return std::nullopt;
    request.value = command.command.values.front();
    request.verify = command.command.verify;
  }
  return finished(std::move(request), command.bus, command.person, std::move(id), now,
                  command.lifespan);
}

std::optional<SiteRequest> site_request_of(const AlarmAction& action, std::string id, UtcTime now) {
  const auto kind = centre_action_of(action.kind);
  if (!kind) return std::nullopt;
  return finished(
      {.action = *kind,
       .channel = {.device = action.alarm.device, .channel = action.alarm.channel},
       .limit = action.alarm.limit,
       .note = action.note,
       .raised_at = action.raised_at,
       .minutes = static_cast<std::uint32_t>(action.duration / std::chrono::minutes{1})},
      action.alarm.bus, action.by, std::move(id), now, kActionLife);
}

StationOutcome site_outcome_from(std::string_view text, std::uint64_t request_id) {
  auto response = forward::command_response_from(text);
  const auto state = response ? state_from(response->state) : std::nullopt;
  if (!state) return tl::make_unexpected(StationFault::kNoResult);
  return StationResult{.request_id = request_id,
                       .state = *state,
                       .cause = std::move(response->cause),
                       .reason = std::move(response->reason),
                       .values = std::move(response->values),
                       .completed_at = response->completed_at};
}

}  // namespace fieldcast::web
