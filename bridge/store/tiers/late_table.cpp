#include "bridge/store/tiers/late_table.hpp"

#include <algorithm>

namespace fieldcast {

bool is_near(const LateRange& a, const LateRange& b) {
  const std::int64_t gap = std::max(saturated_difference(a.from.nanoseconds, b.to.nanoseconds),
                                    saturated_difference(b.from.nanoseconds, a.to.nanoseconds));
  return gap <= kJoinedRanges.count();
}

LateRange joined(const LateRange& a, const LateRange& b) {
  return {std::min(a.from, b.from), std::max(a.to, b.to), a.samples + b.samples,
          std::max(a.received_at, b.received_at)};
}

std::vector<LateRange> LateTable::ranges(const std::string& bus, const std::string& device,
                                         UtcTime from, UtcTime to) {
  std::vector<LateRange> ranges;
  connection_.query(
      "select start, until, samples, received_at from late_ranges where bus = $1 and device = $2 "
      "and start <= $3 and until >= $4 order by start",
      {bus, device, to.nanoseconds, from.nanoseconds}, [&ranges](const SqlRow& row) {
        ranges.push_back({{integer_at(row, 0)},
                          {integer_at(row, 1)},
                          static_cast<std::uint64_t>(integer_at(row, 2)),
                          {integer_at(row, 3)}});
        return true;
      });
  return ranges;
}

void LateTable::add(const std::string& bus, const std::string& device, LateRange range) {
  SqlTransaction transaction(connection_);
  const std::int64_t margin = kJoinedRanges.count();
  for (const LateRange& known :
       ranges(bus, device, {saturated_difference(range.from.nanoseconds, margin)},
              {saturated_difference(range.to.nanoseconds, -margin)})) {
    connection_.execute("delete from late_ranges where bus = $1 and device = $2 and start = $3",
                        SqlRow{bus, device, known.from.nanoseconds});
    range = joined(range, known);
  }
  connection_.execute(
      "insert into late_ranges (bus, device, start, until, samples, received_at) values ($1, $2, "
      "$3, $4, $5, $6)",
      SqlRow{bus, device, range.from.nanoseconds, range.to.nanoseconds,
             static_cast<std::int64_t>(range.samples), range.received_at.nanoseconds});
  connection_.execute(
      "delete from late_ranges where bus = $1 and device = $2 and start <= (select start from "
      "late_ranges where bus = $3 and device = $4 order by start desc limit 1 offset $5)",
      SqlRow{bus, device, bus, device, kMaxKept});
  transaction.commit();
}

}  // namespace fieldcast
