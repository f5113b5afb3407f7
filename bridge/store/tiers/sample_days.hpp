// In PostgreSQL, the samples of each day of UTC are in a separate table, such as samples_20261122,
// that inherits from `samples`; older samples are in `samples` itself. Removal of a day drops its
// table. Not declared partitions: an older store is upgraded without reading its samples, and
// creating or dropping a day does not block readers of others. Everything throws StoreError. One
// owner, the thread of the connection. SQLite has no days.
#pragma once

#include <string>
#include <vector>

#include "bridge/store/sql/sql.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class SampleDays {
 public:
  static constexpr Duration kDay = std::chrono::hours{24};

  explicit SampleDays(SqlConnection& connection) : connection_(connection) {}

  // Returns the table for samples of that time; creates it if it is missing. REQUIRES: PostgreSQL.
  [[nodiscard]] std::string table_for(UtcTime at);
  // Returns the start times of the days that have a table, in order.
  [[nodiscard]] std::vector<UtcTime> all();
  // Removes a day. Returns false if it is in use; try again later.
  [[nodiscard]] bool drop(UtcTime day);
  // Returns true if there are samples of an older Fieldcast outside the day tables.
  [[nodiscard]] bool has_undated();
  // Size of all days with their indexes.
  [[nodiscard]] std::uint64_t bytes();

 private:
  SqlConnection& connection_;
};

}  // namespace fieldcast
