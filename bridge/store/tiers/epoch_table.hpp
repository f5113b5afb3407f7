// Table bus_epochs: the epochs of the catalogue of each bus, in UTC nanoseconds. A sample belongs
// to the last epoch that began before it was published. Everything throws StoreError.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bridge/store/records/records.hpp"
#include "bridge/store/sql/sql.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class EpochTable {
 public:
  static constexpr std::int64_t kMaxKept = 10'000;  // of a bus; the newest are kept

  explicit EpochTable(SqlConnection& connection) : connection_(connection) {}

  // An existing one is not changed.
  void insert(const BusEpoch& epoch);
  [[nodiscard]] std::vector<std::uint64_t> epochs(const std::string& bus);  // ascending

 private:
  SqlConnection& connection_;
};

// Both REQUIRE: `epochs` ascend. Returns the epoch of a sample that was published at this time; 0
// if an older Fieldcast stored it.
[[nodiscard]] std::uint64_t epoch_at(const std::vector<std::uint64_t>& epochs, UtcTime published);
// Returns the time at which a later epoch began; the end of all time if there is none.
[[nodiscard]] UtcTime end_of_epoch(const std::vector<std::uint64_t>& epochs, std::uint64_t epoch);

}  // namespace fieldcast
