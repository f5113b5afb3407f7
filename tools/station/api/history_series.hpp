// History of one channel as columns, one row for each bucket with samples; a gap has no rows. Pure.
#pragma once

#include <string>
#include <vector>

#include "bridge/store/tiers/sample_table.hpp"
#include "bridge/store/tiers/tier.hpp"

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
  bool cut = false;  // more texts follow than were requested
};

// {"from_ms", "to_ms", "series": [{"channel", "known", "unit", "type", "tier", "bucket_ms", "t":
// [], "min": [], "max": [], "average": [], "last": [], "count": [], "bad": []}]}. A text channel
// has "t", "text", "quality" and "cut" instead. The numbers of a bucket without a good sample are
// null.
[[nodiscard]] std::string history_json(UtcTime from, UtcTime to,
                                       const std::vector<HistorySeries>& series);

}  // namespace fieldcast::web
