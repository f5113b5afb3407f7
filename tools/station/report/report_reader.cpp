#include "tools/station/report/report_reader.hpp"

#include <algorithm>

#include "bridge/store/tiers/sample_table.hpp"
#include "bridge/store/tiers/tier_table.hpp"
#include "core/base/value.hpp"

namespace fieldcast::web {

std::vector<ChannelPath> channels_of(SqlConnection& connection,
                                     const std::vector<Pattern>& patterns) {
  std::vector<ChannelPath> found;
  const auto add = [&found](ChannelPath path) {
    if (std::ranges::find(found, path) == found.end()) found.push_back(std::move(path));
  };
  for (const Pattern& pattern : patterns) {
    const auto exact = ChannelPath::parse(pattern.text());
    if (exact && exact->text().find('*') == std::string::npos) {
      add(*exact);
      continue;
    }
    for (const StoredChannel& each : SampleTable(connection).channels(pattern)) {
      if (each.type != to_text(ValueType::kString)) add({each.bus, each.device, each.channel});
    }
  }
  return found;
}

ReportTable read_table(SqlConnection& connection, const ChannelPath& path,
                       const std::vector<ReportPeriod>& periods) {
  ReportTable table{.channel = path.text()};
  const auto channel = SampleTable(connection).find(path);
  table.known = channel.has_value();
  if (!channel || periods.empty()) return table;
  table.unit = channel->unit;
  std::vector<Bucket> minutes;
  if (channel->type != to_text(ValueType::kString))
    TierHistory(connection, kReportMinute)
        .read(*channel, periods.front().from, periods.back().to, [&](const Bucket& bucket) {
          minutes.push_back(bucket);
          return true;
        });
  table.rows = report_rows(minutes, periods);
  return table;
}

}  // namespace fieldcast::web
