#include <algorithm>
#include <string>

#include "core/model/command.hpp"
#include "core/model/spec.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

std::string_view to_text(Mode mode) {
  switch (mode) {
    case Mode::kIntensive: return "intensive";
    case Mode::kScheduled: return "scheduled";
    case Mode::kOnDemand: return "on-demand";
  }
  return "?";
}

std::string_view to_text(Planner planner) {
  switch (planner) {
    case Planner::kCyclic: return "cyclic";
    case Planner::kDynamicBlocks: return "dynamic";
    case Planner::kFastestMember: return "fastest-member";
    case Planner::kOnePerChannel: return "one-per-channel";
  }
  return "?";
}

std::string_view to_text(AlarmPriority priority) {
  switch (priority) {
    case AlarmPriority::kLow: return "low";
    case AlarmPriority::kMedium: return "medium";
    case AlarmPriority::kHigh: return "high";
    case AlarmPriority::kCritical: return "critical";
  }
  return "?";
}

std::string_view to_text(Access access) {
  switch (access) {
    case Access::kReadOnly: return "read-only";
    case Access::kReadWrite: return "read-write";
    case Access::kWriteOnly: return "write-only";
  }
  return "?";
}

std::string_view to_text(LogLevel level) {
  switch (level) {
    case LogLevel::kError: return "error";
    case LogLevel::kWarning: return "warning";
    case LogLevel::kInfo: return "info";
    case LogLevel::kDebug: return "debug";
  }
  return "?";
}

bool read_by_itself(const ChannelSpec& channel) {
  return channel.access != Access::kWriteOnly && channel.mode != Mode::kOnDemand &&
         !channel.on_interest;
}

bool is_requestable(const ChannelSpec& channel) {
  return channel.access != Access::kWriteOnly && !channel.unsolicited && !channel.calculation;
}

std::optional<Duration> promised_gap(const ChannelSpec& channel) {
  if (!read_by_itself(channel)) return std::nullopt;
  if (channel.deadband && channel.heartbeat) return std::max(channel.refresh, *channel.heartbeat);
  return channel.refresh;
}

std::string_view to_text(CommandState state) {
  switch (state) {
    case CommandState::kDone: return "done";
    case CommandState::kVerified: return "verified";
    case CommandState::kRejected: return "rejected";
    case CommandState::kFailed: return "failed";
    case CommandState::kExpired: return "expired";
  }
  return "?";
}

std::string_view to_text(BusState state) {
  switch (state) {
    case BusState::kOpening: return "opening";
    case BusState::kRunning: return "running";
    case BusState::kClosed: return "closed";
    case BusState::kLeased: return "leased";
    case BusState::kStopped: return "stopped";
  }
  return "?";
}

std::string_view to_text(ProgramSessionState state) {
  switch (state) {
    case ProgramSessionState::kOpen: return "open";
    case ProgramSessionState::kClosed: return "closed";
    case ProgramSessionState::kRefused: return "refused";
  }
  return "?";
}

std::string_view to_text(DeviceState state) {
  switch (state) {
    case DeviceState::kUnknown: return "unknown";
    case DeviceState::kOnline: return "online";
    case DeviceState::kDegraded: return "degraded";
    case DeviceState::kOffline: return "offline";
  }
  return "?";
}

bool on_loopback(const ListenSpec& listen) {
  const std::string_view host = listen.host;
  // 127.example.com is a host name.
  const bool digits = host.find_first_not_of("0123456789.") == host.npos;
  return (host.starts_with("127.") && digits) || host == "::1" || host == "localhost";
}

}  // namespace fieldcast
