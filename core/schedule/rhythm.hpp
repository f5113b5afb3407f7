// The beat of a bus: instants on which the reads of a cluster fall due, so that phases neither
// drift nor meet.
//
// If each read were due one period after the last one, whatever made it early would shift all that
// follow, and the phases of a hundred clusters would wander and collide. Instead the fastest point
// of the bus gives a beat a little shorter than its period; each cluster is due on every n-th beat
// at an offset of its own. Reads that come a little early or late leave the beat as it is. Which
// beats, and when within them, says the timetable. Pure functions.
#pragma once

#include <cstdint>

namespace fieldcast {

struct Beat {
  std::int64_t offset = 0;   // of one instant, any
  std::int64_t spacing = 0;  // 0: no beat, due a period after the last acquisition
};

// When a point acquired at `acquired` must be read again: the last beat within its period, or the
// end of the period if that beat is too early to be worth it.
[[nodiscard]] std::int64_t due_after(const Beat& beat, std::int64_t acquired, std::int64_t period);

// The spacing for a cluster whose fastest point has `period`, on a bus whose fastest point has
// `fastest`.
[[nodiscard]] std::int64_t beat_spacing(std::int64_t period, std::int64_t fastest, double margin);

}  // namespace fieldcast
