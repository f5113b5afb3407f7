#include "tools/station/stream/site_commands.hpp"

#include <fmt/format.h>

#include <charconv>
#include <random>
#include <string_view>
#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"
#include "tools/station/stream/site_request.hpp"

namespace fieldcast::web {

namespace {

using Sent = tl::expected<std::uint64_t, StationFault>;

std::string random_text() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}", random(), random());
}

// Empty for a subject that is not one of this station's.
std::optional<std::uint64_t> request_id_of(std::string_view subject) {
  const std::string_view text = subject.substr(subject.rfind('.') + 1);
  std::uint64_t id = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), id);
  if (read.ec != std::errc() || read.ptr != text.data() + text.size()) return std::nullopt;
  return id;
}

}  // namespace

SiteCommands::SiteCommands(const forward::JetStreamSpec& spec, const std::string& station,
                           OnOutcome on_outcome)
    : on_outcome_(std::move(on_outcome)),
      process_(random_text()),
      session_(std::in_place, spec, "fieldcast-station " + station + " commands", true) {}

void SiteCommands::close() {
  responses_.reset();
  session_.reset();
}

bool SiteCommands::is_ready() {
  if (!session_->is_ready(steady_now())) return false;
  if (responses_ != nullptr && generation_ == session_->generation()) return true;
  inbox_ = "_INBOX." + random_text();
  natsSubscription* made = nullptr;
  const natsStatus status = natsConnection_Subscribe(&made, session_->connection(),
                                                     (inbox_ + ".*").c_str(), on_response, this);
  responses_.reset(made);
  generation_ = session_->generation();
  if (status != NATS_OK)
    log_counted(LogLevel::kError, "stream", "failed subscriptions",
                fmt::format("no commands can be sent: {}", natsStatus_GetText(status)));
  return status == NATS_OK;
}

Sent SiteCommands::publish(const std::optional<SiteRequest>& request, std::uint64_t request_id) {
  if (!request) return tl::make_unexpected(StationFault::kNoSite);
  if (!is_ready()) return tl::make_unexpected(StationFault::kNoBridge);
  const natsStatus status =
      natsConnection_PublishRequest(session_->connection(), request->subject.c_str(),
                                    fmt::format("{}.{}", inbox_, request_id).c_str(),
                                    request->text.data(), static_cast<int>(request->text.size()));
  if (status == NATS_OK) return request_id;
  log_counted(LogLevel::kWarning, "stream", "commands that could not be sent",
              natsStatus_GetText(status));
  return tl::make_unexpected(StationFault::kNoBridge);
}

std::string SiteCommands::id_of(std::uint64_t request_id) const {
  return fmt::format("{}-{}", process_, request_id);
}

Sent SiteCommands::send(StationCommand command) {
  const std::uint64_t id = command.command.request_id;
  return publish(site_request_of(command, id_of(id), read_clocks().utc), id);
}

Sent SiteCommands::send(AlarmAction action) {
  return publish(site_request_of(action, id_of(action.request_id), read_clocks().utc),
                 action.request_id);
}

void SiteCommands::on_response(natsConnection*, natsSubscription*, natsMsg* message,
                               void* closure) {
  const forward::NatsMessage owned(message);
  const auto id = request_id_of(natsMsg_GetSubject(message));
  if (!id) return;
  const auto& self = *static_cast<SiteCommands*>(closure);
  // No forwarder of this site is connected, or it accepts no commands.
  if (natsMsg_IsNoResponders(message))
    return self.on_outcome_(*id, tl::make_unexpected(StationFault::kNoBridge));
  self.on_outcome_(
      *id, site_outcome_from(
               {natsMsg_GetData(message), static_cast<std::size_t>(natsMsg_GetDataLength(message))},
               *id));
}

}  // namespace fieldcast::web
