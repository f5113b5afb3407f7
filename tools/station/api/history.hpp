// GET /api/history: up to eight channels of the store, each with a limited number of buckets.
#pragma once

#include "core/model/channel_pattern.hpp"
#include "tools/station/api/base/database.hpp"
#include "tools/station/api/history_series.hpp"
#include "tools/station/http/route_table.hpp"

namespace fieldcast::web {

inline constexpr std::size_t kMaxHistoryChannels = 8;
inline constexpr std::uint32_t kMaxHistoryPoints = 5000;

struct HistoryQuestion {
  std::vector<ChannelPath> channels;
  UtcTime from, to;
  std::uint32_t points = 1000;  // maximum for each channel
};

// Runs on the database thread; throws StoreError. Up to `points` samples are returned unchanged;
// more are aggregated to buckets.
[[nodiscard]] std::vector<HistorySeries> read_history(SqlConnection& connection,
                                                      const HistoryQuestion& question);

// `now` is called on the io thread. `database` is null if the station has no store.
void add_history_routes(RouteTable& table, Database* database, std::function<UtcTime()> now);

}  // namespace fieldcast::web
