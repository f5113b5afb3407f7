// The timetable of a bus: in which time slots each request is sent, and which of its points each
// transmission reads.
//
// Time is cut into slots of one length: the base period of the bus, or a small part of it. The
// table has a number of slots and then repeats; its length is the hyperperiod. A request is sent in
// every n-th slot. Its slower points are read in every m-th slot, by one of its transmissions.
//
// The phase of each point is chosen so that reads are short (neighbours share the gap between them)
// and slots are equally full. First the points are placed one by one, then each again a few times
// with all others in place. Within a slot requests have an order. Each shall end at the same
// instant of every slot in which it is sent, or its fastest points would be late by the difference.
//
// A value: no clock, any thread. It holds what changes of single requests need.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/time.hpp"

namespace fieldcast {

using Slots = std::uint32_t;  // a number of slots, or the index of a slot in the table

struct TimetableMember {
  std::uint32_t first = 0, end = 1;  // its items
  std::uint32_t area = 0;            // of a list: one range reads items of one area only
  std::uint32_t bridge = 0;          // of a list: two points no further apart share one range
  Duration range_cost{};             // of a list: wire time of another range of one item
  double item_ns = 0;                // wire time of another item of a range
  double fits = 1;                   // how many base periods its allowed gap holds
  Slots period = 1;                  // from one reading to the next
  Slots phase = 0;                   // slot of one reading, less than `period`
  friend bool operator==(const TimetableMember&, const TimetableMember&) = default;
};

struct TimetableRequest {
  bool list = false;      // a list of ranges; otherwise one range covers the members that are due
  Duration base_cost{};   // wire time without any item
  Slots period = 1;       // from one transmission to the next
  Slots phase = 0;        // slot of one transmission, less than `period`
  Duration latest_end{};  // its reads end at most so long after the begin of their slot
  std::vector<TimetableMember> members;
  friend bool operator==(const TimetableRequest&, const TimetableRequest&) = default;
};

struct TableLength {
  std::uint32_t parts = 1;  // slots in a base period
  Slots slots = 1;          // of the whole table
  friend bool operator==(const TableLength&, const TableLength&) = default;
};

class Timetable {
 public:
  // `base_period`: what the fastest point of the bus allows. `slack`: how much earlier in its slot
  // a read may end than the one a base period before.
  Timetable(Duration base_period, Duration slack)
      : base_period_(base_period), base_slack_(slack), slot_(base_period), slack_(slack) {}

  // Finds periods and phases for all. Several ways are tried: this becomes the one whose slots end
  // soonest; the others are returned, in the same order.
  std::vector<Timetable> fill(std::vector<TimetableRequest> requests, unsigned rounds);
  // Gives one request other members or costs. The others keep their phases, and so does this one if
  // only its costs are others. After the last of several changes: align().
  void change(std::size_t index, TimetableRequest request);
  // Finds anew when each request ends in its slots.
  void align();

  [[nodiscard]] const TimetableRequest& request(std::size_t index) const {
    return requests_[index];
  }
  [[nodiscard]] Duration slot() const { return slot_; }
  // How much earlier a read may end than planned, for each slot of its request's period.
  [[nodiscard]] Duration slack() const { return slack_; }
  [[nodiscard]] Duration hyperperiod() const { return slot_ * slots_; }
  [[nodiscard]] double load() const;                   // share of the wire that it needs
  [[nodiscard]] double load(std::size_t index) const;  // share that one request needs
  [[nodiscard]] bool empty() const;                    // no request has members

  friend bool operator==(const Timetable&, const Timetable&) = default;

 private:
  void choose_length();
  void settle(unsigned rounds);
  [[nodiscard]] Duration latest_end() const;
  [[nodiscard]] Duration& cost(std::size_t index, Slots slot) {
    return cost_[index * slots_ + slot];
  }
  [[nodiscard]] Duration read_cost(std::size_t index, Slots slot,
                                   std::size_t besides = kNobody) const;
  void mark(std::size_t index, std::size_t member, Slots slot, bool due);
  void set_cost(std::size_t index, Slots slot, Duration cost);
  [[nodiscard]] double strain(std::size_t index, Slots slot, Duration cost) const;
  void enter(std::size_t index);
  void leave(std::size_t index);
  void place(std::size_t index, std::size_t member);
  void take_out(std::size_t index, std::size_t member);

  static constexpr std::size_t kNobody = ~std::size_t{0};
  Duration base_period_, base_slack_;
  Duration slot_, slack_;  // a part of those
  TableLength length_;
  Slots slots_ = 1;     // of the whole table
  Slots shortest_ = 1;  // of all requests' periods
  double level_slots_ = 0, level_steady_ = 0;
  std::vector<TimetableRequest> requests_;
  // By request: a bit for each of its members, slot after slot.
  std::vector<std::vector<std::uint64_t>> due_;
  std::vector<Duration> cost_;    // of each request in each slot
  std::vector<Duration> total_;   // of each slot
  std::vector<Duration> steady_;  // total of each slot, of the requests that are sent most often
};

}  // namespace fieldcast
