// The samples of PostgreSQL lie in one table for each day of UTC, named samples_20261122. Each
// inherits from `samples`, so that a query of `samples` sees all of them, and a day is removed by
// dropping its table, which takes no longer for many samples than for few. What an older Fieldcast
// wrote lies in `samples` itself.
//
// Inherited tables and no declared partitions: an older store is brought to this version without
// reading its samples, and to make or drop a day disturbs nobody who reads another one.
//
// Everything throws StoreError. One owner, the thread of the connection. SQLite has no days.
#pragma once

#include <string>
#include <vector>

#include "bridge/store/sql.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class SampleDays {
 public:
  static constexpr Duration kDay = std::chrono::hours{24};

  explicit SampleDays(SqlConnection& connection) : connection_(connection) {}

  // The table for samples of that time; it is made if it is missing. REQUIRES: PostgreSQL.
  [[nodiscard]] std::string table_for(UtcTime at);
  // When the days that have a table begin, in order.
  [[nodiscard]] std::vector<UtcTime> all();
  // Removes a day. False: not now, somebody reads it.
  [[nodiscard]] bool drop(UtcTime day);
  // True: there are samples of an older Fieldcast, which lie in no day.
  [[nodiscard]] bool has_undated();
  // Of all days, with their indexes.
  [[nodiscard]] std::uint64_t bytes();

 private:
  SqlConnection& connection_;
};

}  // namespace fieldcast
