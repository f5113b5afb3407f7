// Chooses the publication time of a sample, which DDS does not transmit. A good sample uses its
// acquisition time, so that a second or restarted recorder writes the same row. Other samples are
// published later; they use the arrival time by the bridge's clock. Pure; cannot fail.
#pragma once

#include <optional>

#include "bridge/dds/topics/topic_values.hpp"

namespace fieldcast::web {

// Difference between arrival and acquisition of samples of a bus: delay plus clock difference. It
// can be negative.
class ClockOffset {
 public:
  static constexpr Duration kWindow = std::chrono::minutes{1};

  // Adds a good sample; ignores a difference of more than SampleStamp::kMaxOffset.
  void note(UtcTime acquired, UtcTime received);
  [[nodiscard]] Duration least() const;  // minimum of the last one or two windows; 0: no sample

 private:
  std::optional<Duration> before_, now_;
  UtcTime window_began_;
};

class SampleStamp {
 public:
  // Beyond this difference the clock of the bridge is wrong, and the arrival time is used.
  static constexpr Duration kMaxOffset = std::chrono::minutes{10};
  // Maximum age of the first sample, which may be the last value of a slow channel.
  static constexpr Duration kOldest = std::chrono::hours{24};
  // Within this time, samples keep the order of their arrival.
  static constexpr Duration kOrder = std::chrono::seconds{2};

  // Empty for a duplicate. `first`: first sample since the channel exists.
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
