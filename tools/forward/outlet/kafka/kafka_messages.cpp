#include "tools/forward/outlet/kafka/kafka_messages.hpp"

#include <fmt/format.h>

#include "tools/forward/payload/json_payload.hpp"

namespace fieldcast::forward {

const std::string& topic_of(const KafkaTopics& topics, const Record& record) {
  switch (record.kind) {
    case RecordKind::kCatalogue: return topics.catalogues;
    case RecordKind::kAlarm: return topics.alarms;
    case RecordKind::kAudit: return topics.audit;
    case RecordKind::kSamples: break;
  }
  return record.is_late ? topics.late_samples : topics.samples;
}

std::string key_of(std::string_view site, const Record& record) {
  std::string key = fmt::format("{}/{}/{}", site, record.bus, record.device);
  if (record.kind == RecordKind::kCatalogue) key += '/' + hex_text(record.identity);
  return key;
}

}  // namespace fieldcast::forward
