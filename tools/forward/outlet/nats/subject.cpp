#include "tools/forward/outlet/nats/subject.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "tools/forward/payload/json_payload.hpp"

namespace fieldcast::forward {

std::string subject_token(std::string_view name) {
  if (name.empty()) return "=";
  std::string token;
  for (const char c : name) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9') || c == '-' || c == '_';
    if (is_plain) {
      token += c;
    } else {
      token += fmt::format("={:02X}", static_cast<unsigned char>(c));
    }
  }
  return token;
}

std::string subject_of(std::string_view site, std::string_view bucket, const Record& record) {
  const std::string path = fmt::format("{}.{}.{}", subject_token(site), subject_token(record.bus),
                                       subject_token(record.device));
  switch (record.kind) {
    case RecordKind::kSamples:
      return fmt::format("{}.{}", record.is_late ? kLateSubjects : kSampleSubjects, path);
    case RecordKind::kAlarm: return fmt::format("{}.{}", kAlarmSubjects, path);
    case RecordKind::kAudit:
      return fmt::format("{}.{}.{}", kAuditSubjects, subject_token(site),
                         subject_token(record.bus));
    case RecordKind::kCatalogue: break;
  }
  return fmt::format("$KV.{}.{}", bucket,
                     catalogue_key_of(site, record.bus, record.device, record.identity));
}

std::string catalogue_key_of(std::string_view site, std::string_view bus, std::string_view device,
                             std::uint64_t identity) {
  return fmt::format("{}.{}.{}.{}", subject_token(site), subject_token(bus), subject_token(device),
                     hex_text(identity));
}

std::string site_subject_of(std::string_view bucket, std::string_view site) {
  return fmt::format("$KV.{}.{}", bucket, subject_token(site));
}

std::string command_subject_of(std::string_view site) {
  return fmt::format("{}.{}.*", kCommandSubjects, subject_token(site));
}

std::string command_subject_of(std::string_view site, std::string_view user) {
  return fmt::format("{}.{}.{}", kCommandSubjects, subject_token(site), subject_token(user));
}

std::string name_of_token(std::string_view token) {
  std::string name;
  for (std::size_t i = 0; i < token.size(); ++i) {
    if (token[i] != '=') {
      name += token[i];
      continue;
    }
    unsigned byte = 0;
    const char* const end = token.data() + std::min(i + 3, token.size());
    const auto parsed = std::from_chars(token.data() + i + 1, end, byte, 16);
    if (parsed.ec != std::errc() || parsed.ptr != token.data() + i + 3) return {};
    name += static_cast<char>(byte);
    i += 2;
  }
  return subject_token(name) == token ? name : std::string();
}

}  // namespace fieldcast::forward
