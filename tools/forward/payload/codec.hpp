// The payloads as protobuf (forward.proto) and back, for the queue and for the wire. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "tools/forward/batch/sample_batch.hpp"

namespace fieldcast::forward {

inline constexpr std::uint32_t kSchema = 1;

// REQUIRES: the samples are sorted by channel.
[[nodiscard]] std::string encode(const SampleBatch& batch);
[[nodiscard]] std::string encode(std::string_view site, const DeviceCatalogue& catalogue);
[[nodiscard]] std::string encode(std::string_view site, const StationAlarmStatus& alarm);
[[nodiscard]] std::string encode(std::string_view site, const AuditReport& entry);

// The version of a message; empty if the text does not begin as one.
[[nodiscard]] std::optional<std::uint64_t> schema_of(std::string_view text);

// Empty for a text that is not such a message, or whose columns do not match. Without bus and
// device, which the subject names.
[[nodiscard]] std::optional<SampleBatch> decode_samples(std::string_view text);
[[nodiscard]] std::optional<DeviceCatalogue> decode_catalogue(std::string_view text);
[[nodiscard]] std::optional<StationAlarmStatus> decode_alarm(std::string_view text);
[[nodiscard]] std::optional<AuditReport> decode_audit(std::string_view text);

}  // namespace fieldcast::forward
