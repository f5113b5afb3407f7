#include "tools/station/notify/message_text.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>

#include "core/base/json.hpp"
#include "core/base/message_text.hpp"
#include "tools/station/notify/message_id.hpp"

namespace fieldcast::web {
namespace {

constexpr std::size_t kMaxSubject = 300;       // bytes
constexpr std::size_t kMaxText = 60'000;       // bytes
constexpr std::size_t kMaxLinked = 500;        // bytes of an alarm's name in a link
constexpr std::size_t kEncodedWord = 45;       // bytes of text in an encoded word of 75 characters
constexpr std::size_t kBase64Characters = 76;  // of a line

std::string percent(std::string_view text) {
  std::string out;
  for (const unsigned char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '_' || c == '.' || c == '~';
    out += plain ? std::string(1, static_cast<char>(c)) : fmt::format("%{:02X}", c);
  }
  return out;
}

// The largest part of at most `most` bytes that ends between two characters.
std::string_view whole_characters(std::string_view text, std::size_t most) {
  if (text.size() <= most) return text;
  while (most > 0 && (static_cast<unsigned char>(text[most]) & 0xC0) == 0x80) --most;
  return text.substr(0, most);
}

std::string_view subject_word(NotifyKind kind) {
  switch (kind) {
    case NotifyKind::kRaised: return "ALARM";
    case NotifyKind::kRepeated: return "STILL UNACKNOWLEDGED";
    case NotifyKind::kEscalated: return "ESCALATED";
    case NotifyKind::kCleared: return "RETURNED";
    case NotifyKind::kDigest: break;
  }
  return "ALARMS";
}

std::string subject_of(const NotifyMessage& message, const std::string& station) {
  if (message.kind == NotifyKind::kDigest) {
    const auto lines = std::count(message.lines.begin(), message.lines.end(), '\n');
    return fmt::format("{}: {} more messages of {}", subject_word(message.kind),
                       static_cast<std::uint64_t>(lines) + message.more, station);
  }
  return printable(
      fmt::format("{} {}: {} = {}", subject_word(message.kind), to_text(message.status.priority),
                  shown(message.alarm), message.status.value),
      kMaxSubject);
}

std::string text_of(const NotifyMessage& message, const NotifySpec& spec,
                    const std::string& station) {
  std::string text;
  if (message.kind == NotifyKind::kDigest) {
    text = "Several alarms in a short time:\n\n" + message.lines;
    if (message.more > 0) text += fmt::format("and {} more\n", message.more);
    if (!spec.link.empty()) text += fmt::format("\nAlarms: {}/#/alarms\n", spec.link);
  } else {
    const AlarmStatus& status = message.status;
    text = fmt::format("{}\n\nState: {}, {}\nPriority: {}\nValue: {}\nRaised: {}\n",
                       shown(message.alarm), status.active ? "limit exceeded" : "returned",
                       to_text(status.stage), to_text(status.priority), status.value,
                       local_time(status.raised_at));
    if (!status.active) text += fmt::format("Returned: {}\n", local_time(status.cleared_at));
    if (!spec.link.empty())
      text += fmt::format("\nAcknowledge (needs a login): {}\n", link_of(spec.link, message.alarm));
  }
  text += fmt::format("\nStation {}, rule {}, sent {}\n", station, message.rule,
                      local_time(message.at));
  return std::string(whole_characters(text, kMaxText));
}

std::string json_of(const std::string& id, const NotifyMessage& message, const NotifySpec& spec,
                    const std::string& station) {
  JsonObject json;
  json.add("id", id).add("kind", to_text(message.kind)).add("station", station);
  json.add("rule", message.rule).add("at_ms", message.at);
  if (message.kind == NotifyKind::kDigest)
    return json.add("lines", message.lines).add("more", message.more).take();
  const auto& [bus, device, channel, limit] = message.alarm;
  json.add("bus", shown(bus)).add("device", shown(device)).add("channel", shown(channel));
  json.add("limit", to_text(limit)).add("priority", to_text(message.status.priority));
  json.add("state", to_text(message.status.stage)).add("active", message.status.active);
  json.add("value", message.status.value).add("raised_ms", message.status.raised_at);
  json.add("cleared_ms", message.status.cleared_at).add("number", message.number);
  return json.add("link", link_of(spec.link, message.alarm)).take();
}

}  // namespace

std::string base64(std::string_view text) {
  std::string out(sodium_base64_encoded_len(text.size(), sodium_base64_VARIANT_ORIGINAL), '\0');
  sodium_bin2base64(out.data(), out.size(), reinterpret_cast<const unsigned char*>(text.data()),
                    text.size(), sodium_base64_VARIANT_ORIGINAL);
  out.pop_back();  // the zero at the end
  return out;
}

std::string link_of(const std::string& page, const AlarmKey& alarm) {
  if (page.empty()) return {};
  const std::string key =
      fmt::format("{}/{}/{}/{}", alarm.bus, alarm.device, alarm.channel, to_text(alarm.limit));
  if (key.size() > kMaxLinked) return page + "/#/alarms";
  return fmt::format("{}/#/alarms?alarm={}", page, percent(key));
}

std::vector<Notification> rows_of(const NotifyMessage& message, const NotifySpec& spec,
                                  const std::string& station) {
  std::vector<Notification> rows;
  const auto target =
      std::find_if(spec.targets.begin(), spec.targets.end(),
                   [&](const NotifyTarget& each) { return each.name == message.target; });
  if (target == spec.targets.end()) return rows;
  const auto add = [&](std::string id, const std::string& recipient) {
    std::string json = json_of(id, message, spec, station);
    rows.push_back({std::move(id), target->name, recipient, message.at,
                    subject_of(message, station), text_of(message, spec, station),
                    std::move(json)});
  };
  if (target->mail.empty()) add(message.id, "");
  for (const std::string& recipient : target->mail)
    add(message_id({message.id, recipient}), recipient);
  return rows;
}

Notification test_row(const NotifyTarget& target, const std::string& station, UtcTime now) {
  const std::string id = message_id({"test", target.name, std::to_string(now.nanoseconds)});
  JsonObject json;
  json.add("id", id).add("kind", "test").add("station", station).add("at_ms", now);
  return {id,
          target.name,
          target.mail.empty() ? "" : target.mail.front(),
          now,
          "TEST: message of the station " + station,
          fmt::format("This is a test of the target {}. No alarm was raised.\n", target.name),
          json.take()};
}

std::string header_text(std::string_view text) {
  const bool plain =
      std::all_of(text.begin(), text.end(), [](unsigned char c) { return c >= ' ' && c < 0x7F; });
  if (plain && text.size() <= 70 && text.find("=?") == text.npos) return std::string(text);
  std::string out;
  while (!text.empty()) {
    const std::string_view part = whole_characters(text, kEncodedWord);
    text.remove_prefix(part.size());
    out += (out.empty() ? "=?UTF-8?B?" : "\r\n =?UTF-8?B?") + base64(part) + "?=";
  }
  return out;
}

namespace {

constexpr std::string_view kTextPart =
    "Content-Type: text/plain; charset=utf-8\r\nContent-Transfer-Encoding: base64\r\n\r\n";

// Appends the text in lines of RFC 2045.
void append_lines(std::string& mail, std::string_view base64_text) {
  for (; !base64_text.empty();
       base64_text.remove_prefix(std::min(base64_text.size(), kBase64Characters)))
    mail.append(base64_text.substr(0, kBase64Characters)).append("\r\n");
}

// RFC 2046. A line of base64 never begins as the boundary does.
std::string parts_of(const Notification& message) {
  const std::string boundary = "fieldcast-" + message.id;
  std::string parts = fmt::format(
      "Content-Type: multipart/mixed; boundary=\"{0}\"\r\n\r\n--{0}\r\n{1}", boundary, kTextPart);
  append_lines(parts, base64(message.text));
  parts += fmt::format(
      "--{0}\r\nContent-Type: application/octet-stream\r\nContent-Disposition: attachment; "
      "filename=\"{1}\"\r\nContent-Transfer-Encoding: base64\r\n\r\n",
      boundary, message.attachment_name);
  append_lines(parts, message.attachment);
  return parts + fmt::format("--{}--\r\n", boundary);
}

}  // namespace

std::string mail_text(const Notification& message, const std::string& from) {
  const std::string domain = from.substr(from.find('@') + 1);
  std::string mail = fmt::format(
      "From: <{}>\r\nTo: <{}>\r\nSubject: {}\r\nDate: {:%a, %d %b %Y %H:%M:%S} +0000\r\n"
      "Message-ID: <{}@{}>\r\nAuto-Submitted: auto-generated\r\nMIME-Version: 1.0\r\n",
      from, message.recipient, header_text(printable(message.subject, kMaxSubject)),
      fmt::gmtime(static_cast<std::time_t>(message.made_at.nanoseconds / 1'000'000'000)),
      message.id, domain);
  if (!message.attachment_name.empty()) return mail + parts_of(message);
  mail += kTextPart;
  append_lines(mail, base64(message.text));
  return mail;
}

}  // namespace fieldcast::web
