// Decodes messages of the stream. Pure; the content is untrusted.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "tools/station/stream/stream_batch.hpp"

namespace fieldcast::web {

enum class DecodeFault : std::uint8_t {
  kSubject,    // not SUBJECTS.SITE.BUS.DEVICE
  kFrame,      // a damaged zstd frame, or one that is too large
  kForm,       // neither protobuf nor JSON
  kSchema,     // a version that this station does not support
  kContent,    // protobuf or JSON that cannot be decoded
  kCatalogue,  // the bucket has no catalogue of this identity, or it lacks a channel
  kTaken,      // a DDS site of this station has the name of the site
};
[[nodiscard]] std::string_view to_text(DecodeFault fault);

struct StreamMessage {
  std::string_view subject, data;
  UtcTime stored_at;
};

struct StreamSubject {
  std::string site, bus, device;
  bool is_late = false;
};
// "fieldcast.SITE.BUS.DEVICE", "fieldcast-late...", "fieldcast-alarm..". Empty for any other text.
[[nodiscard]] std::optional<StreamSubject> stream_subject_from(std::string_view subject);

// Returns the catalogue of a device of the site; null if the bucket does not have it.
using FindCatalogue = std::function<SharedCatalogue(const std::string& site, const std::string& bus,
                                                    const std::string& device, std::uint64_t)>;

[[nodiscard]] tl::expected<StreamBatch, DecodeFault> decode_batch(const StreamMessage& message,
                                                                  const FindCatalogue& find);
[[nodiscard]] tl::expected<StationAlarmStatus, DecodeFault> decode_alarm(
    const StreamMessage& message);
// An entry of the bucket, with the names of a station.
[[nodiscard]] tl::expected<forward::DeviceCatalogue, DecodeFault> decode_catalogue(
    const std::string& site, std::string_view data);

}  // namespace fieldcast::web
