// Removes what is older than the configuration keeps it: samples and the rows of their tiers. Of a
// store that is too large, each of them loses its oldest part. It removes a few rows after each
// batch, so that no batch waits for it. Samples stay until their tiers are written. A file of
// SQLite gets shorter; PostgreSQL loses whole days at once. One owner, on the writer's thread.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "bridge/store/sql.hpp"
#include "bridge/store/tiers/tier.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

class Retention {
 public:
  // Between two passes over all channels.
  static constexpr Duration kPause = std::chrono::seconds{30};
  // Limits of one step.
  static constexpr std::uint64_t kAtOnce = 5000;  // rows, and once more as many at most
  static constexpr std::size_t kChannelsAtOnce = 100;

  explicit Retention(const StoreSpec& spec) : spec_(spec) {}

  // Does a step, if there is something to do. False: not before the next pass. Throws StoreError.
  bool step(SqlConnection& connection, Instant now, UtcTime utc);

 private:
  // 0: the samples; then the tiers, as in kTiers.
  static constexpr std::size_t kLevels = 1 + kTiers.size();

  void begin(SqlConnection& connection, UtcTime utc);
  void begin_days(SqlConnection& connection);
  [[nodiscard]] UtcTime limit_of(SqlConnection& connection, std::size_t level, UtcTime utc) const;
  [[nodiscard]] bool find_next();
  [[nodiscard]] std::uint64_t remove(SqlConnection& connection);

  const StoreSpec spec_;
  Instant next_pass_ = kLongAgo;
  // Of this pass.
  std::vector<std::int64_t> channels_;     // all of them
  std::size_t level_ = kLevels;            // what is being removed; kLevels: nothing
  std::size_t channel_ = 0;                // the index of the next channel of this level
  std::array<UtcTime, kLevels> before_{};  // older rows are removed; 0: none
  std::uint64_t removed_ = 0;
  bool too_large_ = false;
  bool shrinking_ = false;  // the file of SQLite has more free pages
};

}  // namespace fieldcast
