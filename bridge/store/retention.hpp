// Removes samples and tier rows that are older than configured, or the oldest part of each level if
// the store is too large. Small steps between batches. Samples stay until their tiers are written.
// SQLite files shrink; PostgreSQL drops whole days. One owner, on the writer's thread.
//
// A system clock that is far ahead must not make everything old. Ages therefore refer to a clock
// that follows the system clock, at most kFastest times as fast as time passes while the program
// runs. The database keeps it.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "bridge/store/sql/sql.hpp"
#include "bridge/store/tiers/bucket.hpp"
#include "core/model/store_spec.hpp"

namespace fieldcast {

class Retention {
 public:
  // Between two passes over all channels.
  static constexpr Duration kPause = std::chrono::seconds{30};
  // Limits of one step.
  static constexpr std::uint64_t kAtOnce = 5000;  // rows, and at most the same number again
  static constexpr std::size_t kChannelsAtOnce = 100;
  static constexpr int kFastest = 24;
  // The database gets the clock after each hour of it.
  static constexpr Duration kClockStep = std::chrono::hours{1};

  explicit Retention(const StoreSpec& spec) : spec_(spec) {}

  // Does one step. Returns false if there is no work until the next pass. Throws StoreError.
  bool step(SqlConnection& connection, Instant now, UtcTime utc);

 private:
  // Level 0: the samples; then the tiers, as in kTiers.
  static constexpr std::size_t kLevels = 1 + kTiers.size();

  void begin(SqlConnection& connection, UtcTime utc);
  // Returns the time to which ages refer.
  [[nodiscard]] UtcTime follow(SqlConnection& connection, Instant now, UtcTime utc);
  void begin_days(SqlConnection& connection);
  [[nodiscard]] UtcTime limit_of(SqlConnection& connection, std::size_t level, UtcTime utc) const;
  [[nodiscard]] bool find_next();
  [[nodiscard]] std::uint64_t remove(SqlConnection& connection);

  const StoreSpec spec_;
  Instant next_pass_ = kLongAgo;
  std::optional<Instant> followed_;  // last call of follow()
  UtcTime clock_, stored_clock_;
  // State of the present pass.
  std::vector<std::int64_t> channels_;
  std::size_t level_ = kLevels;            // the present level; kLevels: none
  std::size_t channel_ = 0;                // index of the next channel of this level
  std::array<UtcTime, kLevels> before_{};  // older rows are removed; 0: none
  std::uint64_t removed_ = 0;
  bool too_large_ = false;
  bool shrinking_ = false;  // the SQLite file has more free pages
};

}  // namespace fieldcast
