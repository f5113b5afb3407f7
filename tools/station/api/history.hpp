// GET /api/history: up to eight channels of the store, each in a bounded number of buckets.
#pragma once

#include "core/model/channel_path.hpp"
#include "tools/station/api/database.hpp"
#include "tools/station/api/history_series.hpp"
#include "tools/station/web/route_table.hpp"

namespace fieldcast::web {

inline constexpr std::size_t kMaxHistoryChannels = 8;
inline constexpr std::uint32_t kMaxHistoryPoints = 5000;

struct HistoryQuestion {
  std::vector<ChannelPath> channels;
  UtcTime from, to;
  std::uint32_t points = 1000;  // of each channel, at most
};

// On the thread of the database; throws StoreError. Series in the order of the question. As many
// samples as points, or fewer, are given as they are; more become buckets.
[[nodiscard]] std::vector<HistorySeries> read_history(SqlConnection& connection,
                                                      const HistoryQuestion& question);

// `now` on the io thread. Database: null when the station has no store.
void add_history_routes(RouteTable& table, Database* database, std::function<UtcTime()> now);

}  // namespace fieldcast::web
