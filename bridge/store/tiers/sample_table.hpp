// Samples and channels of a store. Everything throws StoreError.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <span>

#include "bridge/store/records/records.hpp"
#include "bridge/store/sql/sql.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast {

inline constexpr UtcTime kEndOfTime{std::numeric_limits<std::int64_t>::max()};

// A sample that identifies its channel by the store's number.
struct SampleRow {
  std::int64_t channel = 0;
  UtcTime published_at;
  UtcTime acquired_at;
  std::uint64_t sequence = 0;
  Quality quality = Quality::kNotYetRead;
  std::uint16_t device_code = 0;
  Value value;
  bool is_text = false;  // its channel has type string and no tiers
  // May equal the last stored sample of its channel, because DDS delivers the last value again.
  bool perhaps_stored = false;

  [[nodiscard]] bool is_same(const SampleRow& other) const {
    return sequence == other.sequence && acquired_at == other.acquired_at &&
           quality == other.quality;
  }
};

struct StoredChannel {
  std::int64_t id = 0;
  std::string bus, device, channel, unit, type;
};

class SampleTable {
 public:
  static constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max();

  explicit SampleTable(SqlConnection& connection) : connection_(connection) {}

  // Returns the number of a channel; assigns one if it has none.
  [[nodiscard]] std::int64_t channel_id(const std::string& bus, const std::string& device,
                                        const std::string& channel, const std::string& unit,
                                        const std::string& type);
  // Must be called in a transaction. Existing rows are not changed.
  void insert(std::span<const SampleRow> samples);

  // Reads the samples of matching channels with from <= published_at < to, by channel name, then
  // time, until on_sample returns false. Streams the rows. Returns the number of matching channels.
  std::size_t history(const Pattern& pattern, UtcTime from, UtcTime to,
                      const std::function<bool(const StoredSample&)>& on_sample);

  // Reads one channel in parts: at most `limit` samples after `after`, and moves `after` to the
  // last one. Returns the number of samples read; fewer than `limit` means that none are left.
  struct Position {
    UtcTime published_at;
    std::int64_t sequence = std::numeric_limits<std::int64_t>::min();
  };
  std::int64_t part(const StoredChannel& channel, Position& after, UtcTime to, std::int64_t limit,
                    const std::function<void(const StoredSample&)>& on_sample);

  // Samples of a channel with from <= published_at < to, without those
  //   that were published before `after_until` and have no greater sequence than `after`;
  //   that were published at or after `before_from` and have no smaller sequence than `before`.
  struct Span {
    UtcTime from, to = kEndOfTime;
    UtcTime after_until;
    std::uint64_t after = 0;
    UtcTime before_from = kEndOfTime;
    std::uint64_t before = 0;
    friend bool operator==(const Span&, const Span&) = default;
  };
  // Reads at most `limit`, in the order of publication, until on_sample returns false. The names
  // are empty.
  void between(std::int64_t channel, const Span& span, std::int64_t limit,
               const std::function<bool(StoredSample& sample)>& on_sample);
  // Returns the first sample with from <= published_at < to, without its value.
  [[nodiscard]] std::optional<SampleRow> first(std::int64_t channel, UtcTime from, UtcTime to);

  // Returns the channels that match the pattern, sorted by name.
  [[nodiscard]] std::vector<StoredChannel> channels(const Pattern& pattern);
  [[nodiscard]] std::optional<StoredChannel> find(const ChannelPath& path);
  // Reads the samples with from <= published_at < to in the order of time, at most `limit`, until
  // on_number returns false. A text is read as an empty text.
  using OnNumber = std::function<bool(UtcTime at, Quality quality, const Value& value)>;
  void numbers(std::int64_t channel, UtcTime from, UtcTime to, std::int64_t limit,
               const OnNumber& on_number);

  [[nodiscard]] std::vector<std::int64_t> channel_ids();
  // Removes the oldest samples before `before`, about `limit` at most. Returns their number.
  std::uint64_t remove_before(std::int64_t channel, UtcTime before, std::uint64_t limit);
  [[nodiscard]] std::optional<UtcTime> oldest(std::int64_t channel);
  // Returns the newest sample that was published before `before`, without its value.
  [[nodiscard]] std::optional<SampleRow> newest(std::int64_t channel, UtcTime before = kEndOfTime);

 private:
  void insert(std::string_view table, std::span<const SampleRow> samples);

  SqlConnection& connection_;
};

}  // namespace fieldcast
