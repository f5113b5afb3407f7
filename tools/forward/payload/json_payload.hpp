// The payloads as JSON, with all names, for consumers without protobuf. Pure.
#pragma once

#include <string>
#include <string_view>

#include "tools/forward/batch/sample_batch.hpp"

namespace fieldcast::forward {

// `catalogue` is that of the batch; a channel beyond its end is left out.
[[nodiscard]] std::string to_json(std::string_view site, const SampleBatch& batch,
                                  const DeviceCatalogue& catalogue);
[[nodiscard]] std::string to_json(std::string_view site, const DeviceCatalogue& catalogue);
[[nodiscard]] std::string to_json(std::string_view site, const StationAlarmStatus& alarm);
[[nodiscard]] std::string to_json(std::string_view site, const AuditReport& entry);

// "187c0e0f1a2b3c4d": an epoch, or the identity of a catalogue.
[[nodiscard]] std::string hex_text(std::uint64_t number);

}  // namespace fieldcast::forward
