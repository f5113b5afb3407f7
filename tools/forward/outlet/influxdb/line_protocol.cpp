#include "tools/forward/outlet/influxdb/line_protocol.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <type_traits>

namespace fieldcast::forward {

namespace {

constexpr std::int64_t kMostExact = std::int64_t{1} << 53;  // as a double

bool is_exact(const Value& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value))
    return *whole >= -kMostExact && *whole <= kMostExact;
  if (const auto* natural = std::get_if<std::uint64_t>(&value))
    return *natural <= static_cast<std::uint64_t>(kMostExact);
  return true;
}

// "value=2.5," and, for what a double cannot represent, "text=\"..\",".
void add_value(const Value& value, std::string& line) {
  const bool* const boolean = std::get_if<bool>(&value);
  const auto number = boolean == nullptr ? as_number(value) : std::optional(*boolean ? 1.0 : 0.0);
  if (number && std::isfinite(*number))
    fmt::format_to(std::back_inserter(line), "value={},", *number);
  if (!number || !std::isfinite(*number) || !is_exact(value))
    fmt::format_to(std::back_inserter(line), "text={},", quoted_field(to_text(value)));
}

}  // namespace

std::string escaped_tag(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == ',' || c == '=' || c == ' ') escaped += '\\';
    escaped += c == '\n' || c == '\r' ? ' ' : c;
  }
  // A backslash at the end would escape the separator, and an empty tag is not allowed.
  if (escaped.empty() || escaped.back() == '\\') escaped += '_';
  return escaped;
}

std::string quoted_field(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c == '\n' || c == '\r' || c == '\0' ? ' ' : c;
  }
  return quoted + '"';
}

std::string to_lines(std::string_view site, const SampleBatch& batch,
                     const DeviceCatalogue& catalogue) {
  std::string lines;
  const std::string bus = escaped_tag(batch.bus);
  const std::string device = escaped_tag(batch.device);
  const std::string of_site = escaped_tag(site);
  for (const BatchSample& sample : batch.samples) {
    if (sample.channel >= catalogue.channels.size()) continue;
    fmt::format_to(std::back_inserter(lines),
                   "fieldcast,bus={},channel={},device={},quality={},site={} ", bus,
                   escaped_tag(catalogue.channels[sample.channel].channel), device,
                   to_text(sample.quality), of_site);
    add_value(sample.value, lines);
    fmt::format_to(std::back_inserter(lines), "epoch={}i,sequence={}i",
                   static_cast<std::int64_t>(batch.epoch),
                   static_cast<std::int64_t>(sample.sequence));
    if (sample.device_code != 0)
      fmt::format_to(std::back_inserter(lines), ",device_code={}i", sample.device_code);
    fmt::format_to(std::back_inserter(lines), " {}\n", sample.acquired_at.nanoseconds);
  }
  return lines;
}

std::string to_line(std::string_view site, const StationAlarmStatus& alarm) {
  const AlarmStatus& status = alarm.status;
  const std::int64_t at =
      std::max({status.raised_at.nanoseconds, status.cleared_at.nanoseconds,
                status.acknowledged.at.nanoseconds, status.shelved.since.nanoseconds,
                status.suppressed.since.nanoseconds});
  return fmt::format(
      "fieldcast_alarm,bus={},channel={},device={},limit={},site={} "
      "active={},{}stage=\"{}\",priority=\"{}\" {}\n",
      escaped_tag(alarm.alarm.bus), escaped_tag(alarm.alarm.channel),
      escaped_tag(alarm.alarm.device), to_text(alarm.alarm.limit), escaped_tag(site),
      status.active ? 't' : 'f',
      std::isfinite(status.value) ? fmt::format("value={},", status.value) : "",
      to_text(status.stage), to_text(status.priority), at);
}

}  // namespace fieldcast::forward
