// The history of one channel as the page and scripts get it: columns of equal length, one row for
// each bucket that holds something. A bucket without samples has no row: a gap stays a gap. Pure.
#pragma once

#include <string>
#include <vector>

#include "bridge/store/sample_table.hpp"
#include "bridge/store/tiers/tier.hpp"

namespace fieldcast::web {

struct HistorySeries {
  StoredChannel channel;
  bool known = false;  // the store has such a channel
  std::string tier;    // "raw", "minute", "hour": the coarsest that it was read from
  Duration bucket{};   // 0: each row is a sample
  std::vector<Bucket> rows;
  // Of a channel of texts, instead of rows: its samples, up to as many as points were asked for.
  struct Text {
    UtcTime at;
    Quality quality = Quality::kNotYetRead;
    std::string text;
  };
  std::vector<Text> texts;
  bool cut = false;  // there are more texts behind them
};

// {"from_ms", "to_ms", "series": [{"channel", "known", "unit", "type", "tier", "bucket_ms",
// "t": [], "min": [], "max": [], "average": [], "last": [], "count": [], "bad": []}]}. A channel of
// texts has "t", "text", "quality" and "cut" instead. Numbers of a bucket without a good sample are
// null.
[[nodiscard]] std::string history_json(UtcTime from, UtcTime to,
                                       const std::vector<HistorySeries>& series);

}  // namespace fieldcast::web
