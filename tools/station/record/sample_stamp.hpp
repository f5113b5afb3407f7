// When a sample counts as published in a history that is recorded from DDS, which tells only when
// it was acquired. A good sample counts from its acquisition: whoever records it twice, after a
// restart or beside a second recorder, writes the same row. A sample that is not good is published
// some time after its last good value. It counts from its arrival, by the clock of its bridge.
//
// Pure: no clock, no thread; one owner. Nothing can fail.
#pragma once

#include <optional>

#include "bridge/dds/topics/topic_values.hpp"

namespace fieldcast::web {

// How much later this machine receives samples of a bus than its bridge says that it acquired them:
// the way, and what the two clocks differ by. It may be negative.
class ClockOffset {
 public:
  static constexpr Duration kWindow = std::chrono::minutes{1};

  // A good sample; one of more than SampleStamp::kMaxOffset is ignored.
  void note(UtcTime acquired, UtcTime received);
  [[nodiscard]] Duration least() const;  // of the last one or two windows; 0: nothing was noted

 private:
  std::optional<Duration> before_, now_;
  UtcTime window_began_;
};

// The samples of one channel.
class SampleStamp {
 public:
  // A good sample that differs by more counts from its arrival: the clock of its bridge is wrong.
  static constexpr Duration kMaxOffset = std::chrono::minutes{10};
  // Of the first sample, which may be the last value of a channel that is rarely read.
  static constexpr Duration kOldest = std::chrono::hours{24};
  // Within it no sample comes before the one that was received before it.
  static constexpr Duration kOrder = std::chrono::seconds{2};

  // When it counts as published; nothing: it is the sample before it once more. `first`: nothing
  // came since the channel is there.
  [[nodiscard]] std::optional<UtcTime> next(const StationSample& sample, UtcTime received,
                                            Duration offset, bool first);

 private:
  bool any_ = false;
  std::uint64_t sequence_ = 0;
  UtcTime acquired_;
  UtcTime published_;
  Quality quality_ = Quality::kNotYetRead;
};

}  // namespace fieldcast::web
