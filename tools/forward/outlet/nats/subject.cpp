#include "tools/forward/outlet/nats/subject.hpp"

#include <fmt/format.h>

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
    case RecordKind::kCatalogue: break;
  }
  return fmt::format("$KV.{}.{}.{}", bucket, path, hex_text(record.identity));
}

std::string site_subject_of(std::string_view bucket, std::string_view site) {
  return fmt::format("$KV.{}.{}", bucket, subject_token(site));
}

std::string message_id_of(std::string_view site, const Record& record) {
  return fmt::format("{}/{}/{}/{}", site, record.bus, hex_text(record.epoch),
                     hex_text(record.identity));
}

}  // namespace fieldcast::forward
