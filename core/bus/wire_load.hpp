// How busy the wire of one bus is: the time that exchanges took, and the shares of it that reports
// show.
//
// Owns the totals since the start and a mark for each report of the last ten seconds. Owned by the
// bus engine, on the bus's thread. Nothing can fail.
#pragma once

#include <algorithm>
#include <deque>

#include "core/base/time.hpp"

namespace fieldcast {

class WireLoad {
 public:
  static constexpr Duration kWindow = std::chrono::seconds{10};  // of the share of reads
  // Reports at changes of state come between the regular ones, and set no mark.
  static constexpr Duration kMarkGap = std::chrono::milliseconds{900};

  // Shares of time, 0..1.
  struct Shares {
    double busy = 0;     // since the last mark: exchanges and the silences after them
    double reading = 0;  // over the window: reads of the plan
  };

  // An exchange ended that kept the wire for `spent`.
  void ended(Duration spent, bool read) {
    busy_ += spent;
    if (read) reading_ += spent;
  }
  // For a report. The exchange on the wire counts as far as it has come: `running`, zero for none.
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
