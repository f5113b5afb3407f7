// The beat of a bus: instants on which the reads of a cluster fall due, so that phases neither drift nor meet.
//
// If each read were due one period after the last one, whatever made it early would shift all that follow, and the phases of a
// hundred clusters would wander and collide. Instead the fastest point of the bus gives a beat a little shorter than its period;
// each cluster is due on every n-th beat at an offset of its own. Reads that come a little early or late leave the beat as it is.
// Offsets are chosen so that the wire time wanted is level over time. Pure functions; owned by the scheduler.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace fieldcast {

struct Beat {
  std::int64_t offset = 0;   // of one instant, any
  std::int64_t spacing = 0;  // 0: no beat, due a period after the last acquisition
};

// When a point acquired at `acquired` must be read again: the last beat within its period, or the end of the period if that beat
// is too early to be worth it.
[[nodiscard]] std::int64_t due_after(const Beat& beat, std::int64_t acquired, std::int64_t period);

// The spacing for a cluster whose fastest point has `period`, on a bus whose fastest point has `fastest`.
[[nodiscard]] std::int64_t beat_spacing(std::int64_t period, std::int64_t fastest, double margin);

// Finds level offsets: a table of the wire time wanted in each slot of some beats, filled cluster by cluster.
class Leveller {
 public:
  explicit Leveller(std::int64_t beat);
  // Takes `cost` every `spacing` and returns the least crowded offset for it, 0 .. spacing-1.
  [[nodiscard]] std::int64_t place(std::int64_t spacing, std::int64_t cost);
  // The same on a given beat: which of its next `count` instants. Returns 0 .. count-1.
  [[nodiscard]] std::int64_t place_on(const Beat& beat, std::int64_t count, std::int64_t cost);

 private:
  static constexpr std::size_t kBeats = 60;  // divisible by most small numbers
  static constexpr std::size_t kSlots = 24;  // in a beat
  static constexpr int kTries = 48;
  [[nodiscard]] double crowd(std::int64_t offset, std::int64_t spacing) const;
  void take(std::int64_t offset, std::int64_t spacing, std::int64_t cost);

  std::int64_t beat_;
  std::vector<double> slots_;
  std::uint32_t turn_ = 0;
};

}  // namespace fieldcast
