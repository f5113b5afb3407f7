// The samples of a store, and the channels that they belong to. Everything throws StoreError.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <span>

#include "bridge/store/records.hpp"
#include "bridge/store/sql.hpp"
#include "core/model/channel_path.hpp"
#include "core/model/pattern.hpp"

namespace fieldcast {

inline constexpr UtcTime kEndOfTime{std::numeric_limits<std::int64_t>::max()};

// A sample that knows its channel by the store's own number.
struct SampleRow {
  std::int64_t channel = 0;
  UtcTime published_at;
  UtcTime acquired_at;
  std::uint64_t sequence = 0;
  Quality quality = Quality::kNotYetRead;
  std::uint16_t device_code = 0;
  Value value;
  bool is_text = false;  // its channel is of type string: it has no tiers
  // Perhaps the last sample of its channel that is stored already: DDS gives the last value again.
  bool perhaps_stored = false;

  [[nodiscard]] bool is_same(const SampleRow& other) const {
    return sequence == other.sequence && acquired_at == other.acquired_at &&
           quality == other.quality;
  }
};

// A channel that the store knows.
struct StoredChannel {
  std::int64_t id = 0;
  std::string bus, device, channel, unit, type;
};

class SampleTable {
 public:
  static constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max();

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

  // The same for one channel, in parts: the samples behind `after`, `limit` at most, and where they
  // end. Nothing is left when fewer came.
  struct Position {
    UtcTime published_at;
    std::int64_t sequence = std::numeric_limits<std::int64_t>::min();
  };
  std::int64_t part(const StoredChannel& channel, Position& after, UtcTime to, std::int64_t limit,
                    const std::function<void(const StoredSample&)>& on_sample);

  // Those of the pattern, by their names.
  [[nodiscard]] std::vector<StoredChannel> channels(const Pattern& pattern);
  [[nodiscard]] std::optional<StoredChannel> find(const ChannelPath& path);
  // When each sample of a channel of from <= published_at < to was published, its quality and its
  // value, in the order of time, `limit` at most. A text is read as an empty one. False from
  // on_number ends it.
  using OnNumber = std::function<bool(UtcTime at, Quality quality, const Value& value)>;
  void numbers(std::int64_t channel, UtcTime from, UtcTime to, std::int64_t limit,
               const OnNumber& on_number);

  [[nodiscard]] std::vector<std::int64_t> channel_ids();
  // Removes samples of a channel that were published before, the oldest first, about `limit` at
  // most. How many went.
  std::uint64_t remove_before(std::int64_t channel, UtcTime before, std::uint64_t limit);
  [[nodiscard]] std::optional<UtcTime> oldest(std::int64_t channel);  // nothing: it has none
  // The newest one, without its value.
  [[nodiscard]] std::optional<SampleRow> newest(std::int64_t channel);

 private:
  void insert(std::string_view table, std::span<const SampleRow> samples);

  SqlConnection& connection_;
};

}  // namespace fieldcast
