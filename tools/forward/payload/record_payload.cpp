#include "tools/forward/payload/record_payload.hpp"

#include "tools/forward/payload/codec.hpp"
#include "tools/forward/payload/compression.hpp"
#include "tools/forward/payload/json_payload.hpp"

namespace fieldcast::forward {

std::optional<RecordDecoder::Samples> RecordDecoder::samples(const Record& record) {
  std::optional<SampleBatch> batch = decode_samples(record.body);
  if (!batch) return std::nullopt;
  batch->bus = record.bus;
  batch->device = record.device;
  const DeviceCatalogue* const catalogue = catalogue_of(batch->catalogue);
  if (catalogue == nullptr) return std::nullopt;
  return Samples{*std::move(batch), catalogue};
}

const DeviceCatalogue* RecordDecoder::catalogue_of(std::uint64_t identity) {
  if (const auto known = catalogues_.find(identity); known != catalogues_.end())
    return &known->second;
  if (catalogues_.size() >= kMaxCatalogues) catalogues_.clear();
  const auto body = catalogue_(identity);
  auto catalogue = body ? decode_catalogue(*body) : std::nullopt;
  if (!catalogue) return nullptr;
  return &catalogues_.emplace(identity, *std::move(catalogue)).first->second;
}

std::optional<std::string> PayloadMaker::payload_of(const Record& record) {
  std::optional<std::string> payload = record.body;
  if (spec_.format == PayloadFormat::kJson) payload = json_of(record);
  if (!payload) return std::nullopt;
  if (spec_.compress && record.kind == RecordKind::kSamples)
    payload = compressed(*std::move(payload));
  return payload;
}

std::optional<std::string> PayloadMaker::json_of(const Record& record) {
  switch (record.kind) {
    case RecordKind::kCatalogue:
      if (const auto catalogue = decode_catalogue(record.body)) return to_json(site_, *catalogue);
      return std::nullopt;
    case RecordKind::kAlarm:
      if (const auto alarm = decode_alarm(record.body)) return to_json(site_, *alarm);
      return std::nullopt;
    case RecordKind::kAudit:
      if (const auto entry = decode_audit(record.body)) return to_json(site_, *entry);
      return std::nullopt;
    case RecordKind::kSamples: break;
  }
  const auto samples = decoder_.samples(record);
  if (!samples) return std::nullopt;
  return to_json(site_, samples->batch, *samples->catalogue);
}

}  // namespace fieldcast::forward
