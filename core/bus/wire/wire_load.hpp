// Load of one bus: totals and a mark for each report of the last ten seconds. Owned by the bus
// engine, on the bus's thread.
#pragma once

#include <algorithm>
#include <deque>

#include "core/base/time.hpp"

namespace fieldcast {

class WireLoad {
 public:
  static constexpr Duration kWindow = std::chrono::seconds{10};  // for the share of reads
  // Reports at state changes are closer together and set no mark.
  static constexpr Duration kMarkGap = std::chrono::milliseconds{900};

  // Shares of time, 0..1.
  struct Shares {
    double busy = 0;     // since the last mark: exchanges with their silences
    double reading = 0;  // over the window: reads of the plan
  };

  void ended(Duration spent, bool read) {
    busy_ += spent;
    if (read) reading_ += spent;
  }
  // `running`: time of the exchange in flight so far; zero if none.
  [[nodiscard]] Shares report(Duration running, bool read, Instant now) {
    const Mark mark{now, busy_ + running, reading_ + (read ? running : Duration::zero())};
    Shares shares;
    if (!marks_.empty()) {
      shares.busy = share(mark.busy - marks_.back().busy, now - marks_.back().at);
      shares.reading = share(mark.reading - marks_.front().reading, now - marks_.front().at);
    }
    if (marks_.empty() || now - marks_.back().at >= kMarkGap) marks_.push_back(mark);
    while (now - marks_.front().at > kWindow) marks_.pop_front();
    return shares;
  }

 private:
  struct Mark {
    Instant at{};
    Duration busy{}, reading{};
  };
  static double share(Duration part, Duration whole) {
    return whole > Duration::zero() ? std::min(1.0, to_seconds(part) / to_seconds(whole)) : 0.0;
  }

  Duration busy_{}, reading_{};
  std::deque<Mark> marks_;
};

}  // namespace fieldcast
