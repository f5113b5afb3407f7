#include "tools/cli/view/record_view.hpp"

#include <fmt/format.h>

#include "tools/cli/model/sample_text.hpp"

namespace fieldcast::cli {
namespace {

StationSample as_sample(const StoredSample& stored) {
  return {stored.bus,     stored.device,      stored.channel,     stored.value,
          stored.quality, stored.device_code, stored.acquired_at, stored.sequence};
}

// Spreadsheets evaluate a cell that starts with one of these as a formula.
constexpr std::string_view kFormulaStarts = "=+-@\t\r";
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

std::string csv_field(const std::string& raw) {
  std::string text = printable(raw);
  if (!raw.empty() && kFormulaStarts.find(raw.front()) != kFormulaStarts.npos)
    text.insert(text.begin(), '\'');
  if (text.find_first_of(",\"") == text.npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

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
