// Table late_ranges: when samples of a device were acquired that arrived late, for example after an
// outage of the line to its site. Everything throws StoreError.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bridge/store/sql/sql.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

struct LateRange {
  UtcTime from, to;  // of the acquisition; both included
  std::uint64_t samples = 0;
  UtcTime received_at;  // of the last one
  friend bool operator==(const LateRange&, const LateRange&) = default;
};

// Ranges with a smaller distance become one.
inline constexpr Duration kJoinedRanges = std::chrono::minutes{1};
[[nodiscard]] bool is_near(const LateRange& a, const LateRange& b);
// The range of both.
[[nodiscard]] LateRange joined(const LateRange& a, const LateRange& b);

class LateTable {
 public:
  static constexpr std::int64_t kMaxKept = 1'000;  // of a device; the newest are kept

  explicit LateTable(SqlConnection& connection) : connection_(connection) {}

  void add(const std::string& bus, const std::string& device, LateRange range);
  // Those that overlap with this time, in its order.
  [[nodiscard]] std::vector<LateRange> ranges(const std::string& bus, const std::string& device,
                                              UtcTime from, UtcTime to);

 private:
  SqlConnection& connection_;
};

}  // namespace fieldcast
