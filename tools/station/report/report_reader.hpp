// Reads the totals of channels from the store. Throws StoreError.
#pragma once

#include <vector>

#include "bridge/store/sql/sql.hpp"
#include "core/model/channel_pattern.hpp"
#include "tools/station/report/report.hpp"

namespace fieldcast::web {

inline constexpr std::size_t kMaxReported = 64;  // channels of a report
inline constexpr std::size_t kMaxPeriods = 400;

// The channels that match a pattern, pattern by pattern, each once. A pattern without * that
// matches no channel of the store is a channel too. A text matches only a pattern without *.
[[nodiscard]] std::vector<ChannelPath> channels_of(SqlConnection& connection,
                                                   const std::vector<Pattern>& patterns);
// REQUIRES: periods in the order of time.
[[nodiscard]] ReportTable read_table(SqlConnection& connection, const ChannelPath& path,
                                     const std::vector<ReportPeriod>& periods);

}  // namespace fieldcast::web
