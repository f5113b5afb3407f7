#include "tools/forward/payload/json_payload.hpp"

#include <fmt/format.h>

#include "core/base/json.hpp"
#include "tools/forward/payload/codec.hpp"

namespace fieldcast::forward {

namespace {

Json pause_json(const AlarmPause& pause) {
  if (!pause.is_set()) return {};
  return {{"by", pause.by},
          {"note", pause.note},
          {"since", pause.since.nanoseconds},
          {"until", pause.until.nanoseconds}};
}

Json channel_json(const StationChannel& channel) {
  const Limits& limits = channel.limits;
  return {{"channel", channel.channel},
          {"type", channel.type},
          {"unit", channel.unit},
          {"at", channel.at},
          {"description", channel.description},
          {"access", to_text(channel.access)},
          {"mode", to_text(channel.mode)},
          {"refresh", channel.refresh.count()},
          {"low_low", limits.low_low},
          {"low", limits.low},
          {"high", limits.high},
          {"high_high", limits.high_high},
          {"write_min", channel.write_min},
          {"write_max", channel.write_max}};
}

}  // namespace

std::string hex_text(std::uint64_t number) { return fmt::format("{:x}", number); }

std::string to_json(std::string_view site, const SampleBatch& batch,
                    const DeviceCatalogue& catalogue) {
  Json samples = Json::array();
  for (const BatchSample& sample : batch.samples) {
    if (sample.channel >= catalogue.channels.size()) continue;
    Json item{{"channel", catalogue.channels[sample.channel].channel},
              {"value", sample.value},
              {"quality", to_text(sample.quality)},
              {"acquired_at", sample.acquired_at.nanoseconds},
              {"sequence", sample.sequence}};
    if (sample.device_code != 0) item.add("device_code", sample.device_code);
    samples.push_back(item);
  }
  return Json{{"schema", kSchema},
              {"site", site},
              {"bus", batch.bus},
              {"device", batch.device},
              {"epoch", hex_text(batch.epoch)},
              {"catalogue", hex_text(batch.catalogue)},
              {"samples", samples}}
      .text();
}

std::string to_json(std::string_view site, const DeviceCatalogue& catalogue) {
  Json channels = Json::array();
  for (const StationChannel& channel : catalogue.channels)
    channels.push_back(channel_json(channel));
  return Json{{"schema", kSchema},
              {"catalogue", hex_text(identity_of(catalogue))},
              {"site", site},
              {"bus", catalogue.bus},
              {"device", catalogue.device},
              {"channels", channels}}
      .text();
}

std::string to_json(std::string_view site, const StationAlarmStatus& alarm) {
  const AlarmStatus& status = alarm.status;
  return Json{{"schema", kSchema},
              {"site", site},
              {"bus", alarm.alarm.bus},
              {"device", alarm.alarm.device},
              {"channel", alarm.alarm.channel},
              {"limit", to_text(alarm.alarm.limit)},
              {"priority", to_text(status.priority)},
              {"stage", to_text(status.stage)},
              {"active", status.active},
              {"value", status.value},
              {"raised_at", status.raised_at.nanoseconds},
              {"cleared_at", status.cleared_at.nanoseconds},
              {"acknowledged_by", status.acknowledged.by},
              {"acknowledged_note", status.acknowledged.note},
              {"acknowledged_at", status.acknowledged.at.nanoseconds},
              {"shelved", pause_json(status.shelved)},
              {"suppressed", pause_json(status.suppressed)}}
      .text();
}

std::string to_json(std::string_view site, const AuditReport& entry) {
  return Json{{"schema", kSchema},
              {"site", site},
              {"bridge", entry.bridge},
              {"epoch", hex_text(entry.epoch)},
              {"number", entry.number},
              {"at", entry.at.nanoseconds},
              {"who", entry.who},
              {"what", entry.what},
              {"target", entry.target},
              {"bytes_to_device", entry.bytes_to_device},
              {"bytes_from_device", entry.bytes_from_device},
              {"result", entry.result}}
      .text();
}

}  // namespace fieldcast::forward
