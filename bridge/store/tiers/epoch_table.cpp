#include "bridge/store/tiers/epoch_table.hpp"

#include <algorithm>

#include "bridge/store/tiers/sample_table.hpp"

namespace fieldcast {

void EpochTable::insert(const BusEpoch& epoch) {
  connection_.execute("insert into bus_epochs (bus, epoch) values ($1, $2) on conflict do nothing",
                      SqlRow{epoch.bus, static_cast<std::int64_t>(epoch.epoch)});
  connection_.execute(
      "delete from bus_epochs where bus = $1 and epoch <= (select epoch from bus_epochs where bus "
      "= $2 order by epoch desc limit 1 offset $3)",
      SqlRow{epoch.bus, epoch.bus, kMaxKept});
}

std::vector<std::uint64_t> EpochTable::epochs(const std::string& bus) {
  std::vector<std::uint64_t> epochs;
  connection_.query("select epoch from bus_epochs where bus = $1 order by epoch", {bus},
                    [&epochs](const SqlRow& row) {
                      epochs.push_back(static_cast<std::uint64_t>(integer_at(row, 0)));
                      return true;
                    });
  return epochs;
}

std::uint64_t epoch_at(const std::vector<std::uint64_t>& epochs, UtcTime published) {
  if (published.nanoseconds < 0) return 0;
  const auto later =
      std::ranges::upper_bound(epochs, static_cast<std::uint64_t>(published.nanoseconds));
  return later == epochs.begin() ? 0 : *std::prev(later);
}

UtcTime end_of_epoch(const std::vector<std::uint64_t>& epochs, std::uint64_t epoch) {
  const auto later = std::ranges::upper_bound(epochs, epoch);
  return later == epochs.end() ? kEndOfTime : UtcTime{static_cast<std::int64_t>(*later)};
}

}  // namespace fieldcast
