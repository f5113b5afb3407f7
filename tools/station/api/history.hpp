// History of one channel as columns, one row for each bucket with samples; a gap has no rows. Pure.
#pragma once

#include <string>
#include <vector>

#include "bridge/store/sql/sql.hpp"
#include "bridge/store/tiers/bucket.hpp"
#include "bridge/store/tiers/late_table.hpp"
#include "bridge/store/tiers/sample_table.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast::web {

struct HistorySeries {
  StoredChannel channel;
  bool known = false;  // the channel exists in the store
  std::string tier;    // "raw", "minute" or "hour": the coarsest tier that was read
  Duration bucket{};   // 0: each row is a sample
  std::vector<Bucket> rows;
  // Samples of a text channel, instead of `rows`.
  struct Text {
    UtcTime at;
    Quality quality = Quality::kNotYetRead;
    std::string text;
  };
  std::vector<Text> texts;
  bool cut = false;             // more texts follow than were requested
  std::vector<LateRange> late;  // of its device
};

// {"from_ms", "to_ms", "series": [{"channel", "known", "unit", "type", "tier", "bucket_ms", "t":
// [], "min": [], "max": [], "average": [], "last": [], "count": [], "bad": []}]}. A text channel
// has "t", "text", "quality" and "cut" instead. The numbers of a bucket without a good sample are
// null. "late" has the times of samples of the device that arrived late: [{"from_ms", "to_ms",
// "samples", "received_ms"}].
[[nodiscard]] std::string history_json(UtcTime from, UtcTime to,
                                       const std::vector<HistorySeries>& series);

inline constexpr std::size_t kMaxHistoryChannels = 8;
inline constexpr std::uint32_t kMaxHistoryPoints = 5000;

// GET /api/history: up to eight channels of the store, each with a limited number of buckets.
struct HistoryQuestion {
  std::vector<ChannelPath> channels;
  UtcTime from, to;
  std::uint32_t points = 1000;  // maximum for each channel
};

// Runs on the database thread; throws StoreError. Up to `points` samples are returned unchanged;
// more are aggregated to buckets.
[[nodiscard]] std::vector<HistorySeries> read_history(SqlConnection& connection,
                                                      const HistoryQuestion& question);

}  // namespace fieldcast::web
