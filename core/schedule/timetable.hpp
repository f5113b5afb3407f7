// The timetable of a bus: on which beats each request is sent, and which of its reads each point
// rides on.
//
// Time is cut into frames, a little shorter than the fastest refresh of the bus or a small part of
// that. A request goes out in every n-th frame; its slower points ride on every m-th of its reads.
// Which turn each takes is chosen so that reads are short (neighbours share the way to them) and
// frames are level: first one by one, then each again a few times with all others in place. Within
// a frame requests have an order, and each is to end at the same instant of every frame in which it
// is sent, or its fastest points would miss their refresh by the difference. Pure; owned by the
// scheduler.
#pragma once

#include <cstdint>
#include <vector>

namespace fieldcast {

struct TimetableMember {
  std::uint32_t first = 0, end = 1;  // its items
  std::uint32_t area = 0;            // of a list: ranges are of one area each,
  std::uint32_t bridge = 0;          // two that are no further apart share one,
  std::int64_t range_ns = 0;         // and this is what another one of one item adds
  double item_ns = 0;                // wire time of another item of a range
  double fits = 1;                   // how many of the bus's beats its period holds
  std::uint32_t lap = 1;             // frames from one reading to the next
  std::uint32_t turn = 0;            // frame of one reading, less than lap
};

struct TimetableRequest {
  bool list = false;        // a list of ranges; otherwise one range covers the members that are due
  std::int64_t base = 0;    // wire time without any item
  std::uint32_t beat = 1;   // frames from one read to the next
  std::uint32_t phase = 0;  // frame of one read, less than beat
  std::int64_t latest = 0;  // its reads end at most so long after their frame began
  std::vector<TimetableMember> members;
};

class Timetable {
 public:
  // `beat`: what the fastest of the bus allow. `room`: how much later a read of a request may end
  // than the one a beat before.
  Timetable(std::int64_t beat, std::int64_t room)
      : beat_(beat), beat_room_(room), frame_(beat), room_(room) {}

  // Finds laps and turns for all. Several ways are tried: this becomes the one whose frames end
  // soonest; the others are returned, in the same order.
  std::vector<Timetable> fill(std::vector<TimetableRequest> requests, unsigned rounds);
  // Gives one request other members or costs. The others keep their turns, and so does this one if
  // only its costs are others. After the last of several changes: align().
  void change(std::size_t index, TimetableRequest request);
  // Finds anew when each request ends in its frames.
  void align();

  [[nodiscard]] const TimetableRequest& request(std::size_t index) const {
    return requests_[index];
  }
  [[nodiscard]] std::int64_t frame() const { return frame_; }
  [[nodiscard]] std::int64_t room() const { return room_; }
  [[nodiscard]] std::int64_t length() const { return frame_ * frames_; }
  [[nodiscard]] double load() const;  // share of the wire that it needs
  [[nodiscard]] bool empty() const;   // no request has members

 private:
  void choose_length();
  void settle(unsigned rounds);
  [[nodiscard]] std::int64_t latest() const;
  [[nodiscard]] double spent(std::uint32_t parts, std::uint32_t frames) const;
  void set_laps(TimetableRequest& request) const;
  [[nodiscard]] std::int64_t& cost(std::size_t index, std::uint32_t frame) {
    return cost_[index * frames_ + frame];
  }
  [[nodiscard]] std::int64_t read(std::size_t index, std::uint32_t frame,
                                  std::size_t besides = kNobody) const;
  void mark(std::size_t index, std::size_t member, std::uint32_t frame, bool due);
  void set_cost(std::size_t index, std::uint32_t frame, std::int64_t cost);
  [[nodiscard]] double strain(std::size_t index, std::uint32_t frame, std::int64_t cost) const;
  void enter(std::size_t index);
  void leave(std::size_t index);
  void place(std::size_t index, std::size_t member);
  void take_out(std::size_t index, std::size_t member);

  static constexpr std::size_t kNobody = ~std::size_t{0};
  std::int64_t beat_, beat_room_;
  std::int64_t frame_, room_;   // a part of a beat
  std::uint32_t parts_ = 1;     // frames in a beat
  std::uint32_t frames_ = 1;    // of the whole table
  std::uint32_t shortest_ = 1;  // of all requests' beats
  double level_frames_ = 0, level_steady_ = 0;
  std::vector<TimetableRequest> requests_;
  std::vector<std::vector<std::uint64_t>>
      due_;                          // by request: a bit for each of its members, frame after frame
  std::vector<std::int64_t> cost_;   // of each request in each frame
  std::vector<std::int64_t> total_;  // of each frame
  std::vector<std::int64_t> steady_;  // the same, of the requests that are sent most often
};

}  // namespace fieldcast
