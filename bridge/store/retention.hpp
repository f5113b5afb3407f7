// Removes samples that are older than the configuration keeps them, and the oldest ones when the
// store is too large. It removes a few after each batch, so that no batch waits for it. One owner,
// on the writer's thread.
#pragma once

#include <vector>

#include "bridge/store/sql.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

class Retention {
 public:
  // Between two passes over all channels.
  static constexpr Duration kPause = std::chrono::seconds{30};
  static constexpr std::uint64_t kAtOnce = 5000;  // samples in one step

  explicit Retention(const StoreSpec& spec) : spec_(spec) {}

  // Does a step, if there is something to do. False: not before the next pass. Throws StoreError.
  bool step(SqlConnection& connection, Instant now, UtcTime utc);

 private:
  void begin(SqlConnection& connection, UtcTime utc);

  const StoreSpec spec_;
  Instant next_pass_ = kLongAgo;
  std::vector<std::int64_t> channels_;  // still to be checked in this pass
  UtcTime before_;                      // older samples are removed
  bool too_large_ = false;
};

}  // namespace fieldcast
