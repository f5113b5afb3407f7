// The samples of a store, and the channels that they belong to. Everything throws StoreError.
#pragma once

#include <functional>
#include <span>

#include "bridge/store/records.hpp"
#include "bridge/store/sql.hpp"
#include "core/model/pattern.hpp"

namespace fieldcast {

// A sample that knows its channel by the store's own number.
struct SampleRow {
  std::int64_t channel = 0;
  UtcTime published_at;
  UtcTime acquired_at;
  std::uint64_t sequence = 0;
  Quality quality = Quality::kNotYetRead;
  std::uint16_t device_code = 0;
  Value value;
};

class SampleTable {
 public:
  explicit SampleTable(SqlConnection& connection) : connection_(connection) {}

  // The number of a channel, given to it now if it has none.
  [[nodiscard]] std::int64_t channel_id(const std::string& bus, const std::string& device,
                                        const std::string& channel, const std::string& unit,
                                        const std::string& type);
  // In one transaction of the caller. What is there already stays as it is.
  void insert(std::span<const SampleRow> samples);

  // The samples of all channels of the pattern that were published from `from` on and before `to`:
  // channel by channel in the order of their names, each in the order of time. False from on_sample
  // ends it. Nothing is held: any number. Returns how many channels of the pattern the store knows.
  std::size_t history(const Pattern& pattern, UtcTime from, UtcTime to,
                      const std::function<bool(const StoredSample&)>& on_sample);

  [[nodiscard]] std::vector<std::int64_t> channel_ids();
  // Removes samples of a channel that were published before, the oldest first, about `limit` at
  // most. How many went.
  std::uint64_t remove_before(std::int64_t channel, UtcTime before, std::uint64_t limit);
  [[nodiscard]] UtcTime oldest(std::int64_t channel);  // 0: it has none

 private:
  SqlConnection& connection_;
};

}  // namespace fieldcast
