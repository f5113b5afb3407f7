// Helpers of the store tests: times, samples of one device, histories.
//
// Runs on the thread of the test. history() throws StoreError if there is no store.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bridge/store/sql/schema.hpp"
#include "bridge/store/store.hpp"
#include "bridge/store/tiers/sample_table.hpp"
#include "bridge/store/tiers/tier_writer.hpp"

namespace fieldcast::test {

inline const UtcMapping kClock{Instant{std::chrono::seconds{1000}},
                               UtcTime{1'700'000'000'000'000'000}};
inline UtcTime utc(std::int64_t second) {
  return UtcTime{kClock.utc.nanoseconds + second * 1'000'000'000};
}
inline Instant instant(std::int64_t second) {
  return kClock.instant + std::chrono::seconds{second};
}
inline const UtcTime kEnd{INT64_MAX};

inline StoreSpec forever(const StoreAddress& address) {
  StoreSpec spec{address.text()};
  spec.keep = {};
  return spec;
}

inline BusSpec bus_of(const std::string& name, std::vector<std::string> channels) {
  BusSpec bus;
  bus.name = name;
  DeviceSpec device;
  device.name = "d";
  for (auto& channel : channels) {
    ChannelSpec made;
    made.name = channel;
    made.unit = "°C";
    made.encoding.type = ValueType::kFloat32;
    device.channels.push_back(made);
  }
  bus.devices.push_back(device);
  return bus;
}

inline Sample sample(ChannelIndex channel, Value value, std::int64_t second,
                     std::uint64_t sequence = 1) {
  return {.channel = channel,
          .value = std::move(value),
          .quality = Quality::kGood,
          .acquired = instant(second),
          .sequence = sequence};
}

inline void write_tiers(SqlConnection& connection) {
  TierWriter tiers;
  while (tiers.step(connection, utc(1'000'000))) {}
}

inline std::vector<StoredSample> history(const StoreAddress& address, const std::string& pattern,
                                         UtcTime from = {}, UtcTime to = kEnd) {
  std::vector<StoredSample> found;
  const auto connection = open_store(address, IfMissing::kFail);
  SampleTable(*connection)
      .history(*Pattern::parse(pattern), from, to, [&](const StoredSample& stored) {
        found.push_back(stored);
        return true;
      });
  return found;
}

}  // namespace fieldcast::test
