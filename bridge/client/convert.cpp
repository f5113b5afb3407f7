#include "bridge/client/convert.hpp"

#include <type_traits>
#include <utility>

#include "core/codec/value_codec.hpp"

namespace fieldcast::api {

namespace {

// The enumerations of both sides have the same order.
template <class To, class From>
constexpr To same(From value) {
  return static_cast<To>(static_cast<std::underlying_type_t<From>>(value));
}
static_assert(std::is_same_v<Value, fieldcast::Value>);
static_assert(same<fieldcast::Quality>(Quality::kNotYetRead) == fieldcast::Quality::kNotYetRead);
static_assert(same<fieldcast::Access>(Access::kWriteOnly) == fieldcast::Access::kWriteOnly);
static_assert(same<LimitKind>(Limit::kHighHigh) == LimitKind::kHighHigh);
static_assert(same<AlarmPriority>(Priority::kCritical) == AlarmPriority::kCritical);
static_assert(same<fieldcast::AlarmStage>(AlarmStage::kReturned) ==
              fieldcast::AlarmStage::kReturned);

Outcome outcome_of(CommandState state) {
  switch (state) {
    case CommandState::kDone: return Outcome::kDone;
    case CommandState::kVerified: return Outcome::kVerified;
    case CommandState::kRejected: return Outcome::kRejected;
    case CommandState::kExpired: return Outcome::kExpired;
    case CommandState::kFailed: break;
  }
  return Outcome::kFailed;
}

}  // namespace

inline namespace v1 {

std::string to_text(const Value& value) { return fieldcast::to_text(value); }
std::optional<double> as_number(const Value& value) { return fieldcast::as_number(value); }
std::string_view to_text(Quality quality) {
  return fieldcast::to_text(same<fieldcast::Quality>(quality));
}
std::string_view to_text(Limit limit) { return fieldcast::to_text(same<LimitKind>(limit)); }
std::string_view to_text(Priority priority) {
  return fieldcast::to_text(same<AlarmPriority>(priority));
}
std::string_view to_text(AlarmStage stage) {
  return fieldcast::to_text(same<fieldcast::AlarmStage>(stage));
}

Duration age(const Sample& sample) {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now()) -
         sample.acquired_at;
}

std::string_view to_text(Outcome outcome) {
  switch (outcome) {
    case Outcome::kDone: return "done";
    case Outcome::kVerified: return "verified";
    case Outcome::kRejected: return "rejected";
    case Outcome::kFailed: return "failed";
    case Outcome::kExpired: return "expired";
    case Outcome::kNotSent: return "not sent";
    case Outcome::kNoResult: return "no result";
  }
  return "unknown";
}

std::string to_text(const Result& result) {
  std::string text(to_text(result.outcome));
  if (!result.reason.empty()) text.append(": ").append(result.reason);
  if (!result.cause.empty()) text.append(" (").append(result.cause).append(")");
  return text;
}

}  // namespace v1

Time to_public(UtcTime time) { return Time{Duration{time.nanoseconds}}; }
UtcTime to_inner(Time time) { return {time.time_since_epoch().count()}; }

DdsSite to_inner(const Domain& domain) {
  DdsSite site;
  site.name = domain.name;
  site.dds.domain = domain.domain;
  site.dds.interfaces = domain.interfaces;
  site.dds.discovery_servers = domain.discovery_servers;
  site.dds.profile = domain.profile;
  site.dds.partition = domain.partition;
  site.dds.security = domain.security;
  return site;
}

Sample to_public(const StationSample& sample) {
  return {.path = {sample.bus, sample.device, sample.channel},
          .value = sample.value,
          .quality = same<Quality>(sample.quality),
          .device_code = sample.device_code,
          .acquired_at = to_public(sample.acquired_at),
          .sequence = sample.sequence};
}

Channel to_public(const StationChannel& channel) {
  return {.path = {channel.bus, channel.device, channel.channel},
          .bridge = channel.bridge,
          .type = channel.type,
          .unit = channel.unit,
          .address = channel.at,
          .description = channel.description,
          .access = same<Access>(channel.access),
          .refresh = channel.refresh,
          .low_low = channel.limits.low_low,
          .low = channel.limits.low,
          .high = channel.limits.high,
          .high_high = channel.limits.high_high,
          .write_min = channel.write_min,
          .write_max = channel.write_max};
}

Alarm to_public(const StationAlarmStatus& status) {
  const auto& [key, alarm] = status;
  return {.path = {key.bus, key.device, key.channel},
          .limit = same<Limit>(key.limit),
          .priority = same<Priority>(alarm.priority),
          .stage = same<AlarmStage>(alarm.stage),
          .value = alarm.value,
          .raised_at = to_public(alarm.raised_at),
          .cleared_at = to_public(alarm.cleared_at),
          .occurrences = alarm.occurrences,
          .acknowledged_by = alarm.acknowledged.by,
          .note = alarm.acknowledged.note,
          .shelved = alarm.shelved.is_set(),
          .suppressed = alarm.suppressed.is_set()};
}

BusStatus to_public(const StationBusStatus& status) {
  return {.bridge = status.bridge,
          .bus = status.bus,
          .state = std::string(fieldcast::to_text(status.report.state)),
          .utilisation = status.report.utilisation,
          .planned_load = status.report.planned_load,
          .exchanges = status.report.exchanges,
          .samples = status.report.samples,
          .commands = status.report.commands,
          .missed_refreshes = status.report.deadline_misses,
          .causes = status.causes,
          .reported_at = to_public(status.reported_at)};
}

DeviceStatus to_public(const StationDeviceStatus& status) {
  return {.bus = status.bus,
          .device = status.device,
          .state = std::string(fieldcast::to_text(status.report.state)),
          .exchanges = status.report.exchanges,
          .failures = status.report.failures,
          .retries = status.report.retries,
          .missed_refreshes = status.report.deadline_misses,
          .response_time = status.report.response_time,
          .refused = status.report.refused,
          .causes = status.causes,
          .reported_at = to_public(status.reported_at)};
}

Bridge to_public(const StationBridge& bridge) {
  Bridge result{.bridge = bridge.bridge,
                .host = bridge.host,
                .version = bridge.version,
                .standby_group = bridge.standby_group,
                .buses = {},
                .since = to_public(bridge.since)};
  for (const StationBridge::Bus& bus : bridge.buses) {
    if (bus.serving) result.buses.push_back(bus.bus);
  }
  return result;
}

ReadPlan to_public(const StationReadPlan& plan) {
  ReadPlan result{.bus = plan.bus,
                  .load = plan.plan.load,
                  .stretch = plan.plan.stretch,
                  .slot = plan.plan.slot,
                  .hyperperiod = plan.plan.hyperperiod,
                  .groups = {},
                  .in_force_since = to_public(plan.in_force_since)};
  for (const auto& [device, list, period, phase, slack, load, points] : plan.plan.groups) {
    auto& group =
        result.groups.emplace_back(ReadPlan::Group{device, list, period, phase, slack, load, {}});
    for (const auto& [area, first, count, channels, every, at, worst_gap, stretch] : points)
      group.points.push_back({area, first, count, channels, every, at, worst_gap, stretch});
  }
  return result;
}

ProgrammingSession to_public(const ProgramSessionReport& session) {
  return {.bus = session.bus,
          .device = session.device,
          .state = std::string(fieldcast::to_text(session.state)),
          .engineer = session.who,
          .bytes_to_device = session.bytes_to_device,
          .bytes_from_device = session.bytes_from_device,
          .since = to_public(session.since)};
}

Result to_public(const StationOutcome& outcome) {
  if (!outcome) {
    const bool sent = outcome.error() == StationFault::kNoResult;
    Result failed;
    failed.outcome = sent ? Outcome::kNoResult : Outcome::kNotSent;
    failed.reason = fieldcast::to_text(outcome.error());
    return failed;
  }
  return {.outcome = outcome_of(outcome->state),
          .cause = outcome->cause == "NONE" ? std::string{} : outcome->cause,
          .reason = outcome->reason,
          .device_code = outcome->device_code,
          .values = outcome->values,
          .received_at = to_public(outcome->received_at),
          .started_at = to_public(outcome->started_at),
          .completed_at = to_public(outcome->completed_at)};
}

tl::expected<AddressTarget, std::string> to_inner(const Address& address) {
  auto encoding = encoding_from(address.type);
  if (!encoding) {
    return tl::unexpected("type '" + address.type + "' is unknown; there are " +
                          fieldcast::allowed_types());
  }
  if (address.low_word_first) encoding->word_order = WordOrder::kLittleEndian;
  if (address.low_byte_first) encoding->byte_order = ByteOrder::kLittleEndian;
  encoding->bit = address.bit;
  encoding->scale = address.scale;
  encoding->offset = address.offset;
  return AddressTarget{address.at, *std::move(encoding)};
}

AlarmKey key_of(const Alarm& alarm) {
  return {alarm.path.bus, alarm.path.device, alarm.path.channel, same<LimitKind>(alarm.limit)};
}

}  // namespace fieldcast::api
