#include "tools/cli/view/record_view.hpp"

#include <fmt/format.h>

#include "core/base/csv_field.hpp"
#include "core/base/value.hpp"
#include "tools/cli/model/sample_text.hpp"

namespace fieldcast::cli {

namespace {

// Statistics of the good samples with all digits; `none` if there are none.
struct Numbers {
  std::string min, max, average;
};
Numbers numbers_of(const StoredChannel& channel, const Bucket& bucket, const std::string& none) {
  if (bucket.count == 0) return {none, none, none};
  return {value_text(bucket.min, channel.type), value_text(bucket.max, channel.type),
          number_text(*bucket.average())};
}

std::string columns(std::string_view time, std::size_t time_width, std::string_view min,
                    std::string_view max, std::string_view average, std::string_view count,
                    std::string_view bad, std::string_view channel) {
  return fmt::format("{:<{}}  {:>12}  {:>12}  {:>12}  {:>6}  {:>5}  {}", time, time_width, min, max,
                     average, count, bad, channel);
}

std::size_t width_of_time(Zone zone) { return zone == Zone::kUtc ? 24 : 29; }

}  // namespace

std::string bucket_head(Zone zone) {
  return columns("time", width_of_time(zone), "min", "max", "average", "count", "bad", "channel");
}

std::string bucket_line(const StoredChannel& channel, const Bucket& bucket, Zone zone) {
  Numbers numbers = numbers_of(channel, bucket, "-");
  // A mean has more digits than are useful.
  if (bucket.count > 0) numbers.average = fmt::format("{:.7g}", *bucket.average());
  std::string path = channel.bus + '/' + channel.device + '/' + channel.channel;
  if (!channel.unit.empty()) path += " (" + channel.unit + ')';
  return printable(columns(time_text(bucket.start, zone), width_of_time(zone), numbers.min,
                           numbers.max, numbers.average, std::to_string(bucket.count),
                           std::to_string(bucket.bad), path));
}

std::string bucket_csv_head() { return "time,min,max,average,count,bad,bus,device,channel,unit"; }

std::string bucket_csv(const StoredChannel& channel, const Bucket& bucket, Zone zone) {
  const Numbers numbers = numbers_of(channel, bucket, "");
  return fmt::format("{},{},{},{},{},{},{},{},{},{}", time_text(bucket.start, zone), numbers.min,
                     numbers.max, numbers.average, bucket.count, bucket.bad, csv_field(channel.bus),
                     csv_field(channel.device), csv_field(channel.channel),
                     csv_field(channel.unit));
}

Json bucket_json(const StoredChannel& channel, const Bucket& bucket) {
  const auto number = [&](double value) { return bucket.count == 0 ? Json() : Json(value); };
  return {{"bus", channel.bus},
          {"device", channel.device},
          {"channel", channel.channel},
          {"time", bucket.start.nanoseconds},
          {"min", number(bucket.min)},
          {"max", number(bucket.max)},
          {"average", number(bucket.average().value_or(0))},
          {"count", bucket.count},
          {"bad", bucket.bad}};
}

namespace {

StationSample as_sample(const StoredSample& stored) {
  return {stored.bus,     stored.device,      stored.channel,     stored.value,
          stored.quality, stored.device_code, stored.acquired_at, stored.sequence};
}

constexpr std::string_view kTransmission = "program";  // audit entries with byte counts

bool was_read(const StoredSample& sample) { return sample.acquired_at.nanoseconds != 0; }

// Only a text can be a formula; a number such as "-5" stays unchanged.
std::string csv_value(const StoredSample& sample) {
  const std::string text = value_text(sample.value, sample.type);
  return std::holds_alternative<std::string>(sample.value) ? csv_field(text) : text;
}

std::string path_of(const StoredSample& sample) {
  return sample.bus + '/' + sample.device + '/' + sample.channel;
}

}  // namespace

Json record_json(const StoredSample& sample) {
  Json json = sample_json(as_sample(sample));
  json.add("published_at", sample.published_at.nanoseconds);
  return json;
}

Json record_json(const AuditEntry& entry) {
  Json json = {{"at", entry.at.nanoseconds},
               {"who", entry.who},
               {"what", entry.what},
               {"target", entry.target}};
  if (entry.what == kTransmission) {
    json.add("bytes_to_device", entry.bytes_to_device);
    json.add("bytes_from_device", entry.bytes_from_device);
  }
  json.add("result", entry.result);
  return json;
}

Json record_json(const DeviceRecord& device) {
  return {{"bus", device.bus},           {"device", device.device},
          {"protocol", device.protocol}, {"address", device.address},
          {"state", device.state},       {"since", device.since.nanoseconds}};
}

Json record_json(const User& user) {
  return {{"user", user.name},
          {"role", to_text(user.role)},
          {"created_at", user.created_at.nanoseconds}};
}

Json record_json(const Token& token) {
  return {{"token", token.name},
          {"created_at", token.created_at.nanoseconds},
          {"ends_at", token.ends_at.nanoseconds}};
}

std::string history_line(const StoredSample& sample, Zone zone) {
  std::string line =
      fmt::format("{}  {}  {}", time_text(sample.published_at, zone), path_of(sample),
                  was_read(sample) ? value_text(sample.value, sample.type) : "-");
  if (!sample.unit.empty()) line += ' ' + sample.unit;
  line += "  " + quality_text(as_sample(sample));
  // Only a republished value is older than its sample.
  if (sample.quality != Quality::kGood && was_read(sample))
    line += fmt::format(" (of {})", time_text(sample.acquired_at, zone));
  return printable(line);
}

std::string history_csv_head() {
  return "published_at,acquired_at,bus,device,channel,value,unit,quality";
}

std::string history_csv(const StoredSample& sample, Zone zone) {
  const bool read = was_read(sample);
  return fmt::format("{},{},{},{},{},{},{},{}", time_text(sample.published_at, zone),
                     read ? time_text(sample.acquired_at, zone) : "", csv_field(sample.bus),
                     csv_field(sample.device), csv_field(sample.channel),
                     read ? csv_value(sample) : "", csv_field(sample.unit),
                     to_text(sample.quality));
}

std::string audit_line(const AuditEntry& entry) {
  std::string line = fmt::format("{}  {}  {}", utc_text(entry.at), entry.who, entry.what);
  if (!entry.target.empty()) line += ' ' + entry.target;
  if (entry.bytes_to_device + entry.bytes_from_device > 0) {
    line += fmt::format("  {} bytes to the device, {} from it", entry.bytes_to_device,
                        entry.bytes_from_device);
  }
  return printable(fmt::format("{}  {}", line, entry.result));
}

std::vector<std::string> device_lines(const std::vector<DeviceRecord>& devices, UtcTime now,
                                      const Screen& screen) {
  TextTable table({{"device"}, {"state"}, {"for", Align::kRight}, {"protocol"}, {"address"}});
  for (const DeviceRecord& device : devices) {
    const Tone tone = device.state == "online"    ? Tone::kGood
                      : device.state == "offline" ? Tone::kBad
                                                  : Tone::kWarning;
    table.add_row({{device.bus + '/' + device.device},
                   {device.state, tone},
                   {age_text(device.since, now), Tone::kFaint},
                   {device.protocol},
                   {device.address}});
  }
  return table.render(screen);
}

std::vector<std::string> user_lines(const std::vector<User>& users, const Screen& screen) {
  TextTable table({{"user"}, {"role"}, {"since"}});
  for (const User& user : users)
    table.add_row({{user.name},
                   {std::string(to_text(user.role))},
                   {utc_text(user.created_at), Tone::kFaint}});
  return table.render(screen);
}

std::vector<std::string> token_lines(const std::vector<Token>& tokens, UtcTime now,
                                     const Screen& screen) {
  TextTable table({{"token"}, {"until"}, {"since"}});
  for (const Token& token : tokens) {
    const bool ended = token.ends_at <= now;
    table.add_row(
        {{token.name},
         {utc_text(token.ends_at) + (ended ? " (ended)" : ""), ended ? Tone::kFaint : Tone::kPlain},
         {utc_text(token.created_at), Tone::kFaint}});
  }
  return table.render(screen);
}

}  // namespace fieldcast::cli
