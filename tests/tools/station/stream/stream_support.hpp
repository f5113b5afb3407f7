// Messages of the site `north` for the tests of the stream.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tools/forward/payload/codec.hpp"
#include "tools/station/stream/stream_batch.hpp"

namespace fieldcast::web::test {

// line/press with the channels a, b, ..
inline forward::DeviceCatalogue catalogue_of(const std::string& bus,
                                             const std::vector<std::string>& names) {
  forward::DeviceCatalogue made{bus, "press", {}};
  for (const std::string& name : names) {
    StationChannel channel;
    channel.bus = bus;
    channel.device = "press";
    channel.channel = name;
    channel.type = "float32";
    made.channels.push_back(channel);
  }
  return made;
}

inline constexpr std::int64_t kSecond = 1'000'000'000;
// A minute begins at second 0.
inline UtcTime at(std::int64_t second) { return {(1'700'000'040 + second) * kSecond}; }

// A sample of channel 0, acquired at `sequence` seconds; its value is the sequence.
inline forward::BatchSample sample(std::uint64_t sequence, Quality quality = Quality::kGood) {
  return {.channel = 0,
          .sequence = sequence,
          .acquired_at = at(static_cast<std::int64_t>(sequence)),
          .value = static_cast<double>(sequence),
          .quality = quality};
}

inline StreamBatch batch_of(std::vector<forward::BatchSample> samples, UtcTime stored_at,
                            bool is_late = false) {
  StreamBatch batch{.site = "north", .is_late = is_late, .stored_at = stored_at};
  batch.catalogue =
      std::make_shared<const forward::DeviceCatalogue>(catalogue_of("north:line", {"a", "b"}));
  batch.samples = {"north:line", "press", 7, 99, std::move(samples)};
  return batch;
}

}  // namespace fieldcast::web::test
