// The timetable of a bus: the slots in which each request is sent, and the points that each
// transmission reads. Time is divided into slots: the base period of the bus, or a small part of
// it. The table repeats after its hyperperiod. A request is sent in every n-th slot; its slower
// points are read in every m-th slot.
//
// Phases are chosen for short reads (neighbours share the gap between them) and equal load of
// slots. Points are placed one by one, then each is placed again a few times. Within a slot
// requests have an order. Each must end at the same time in all its slots, as its fastest points
// would be late by the difference otherwise. Keeps the data needed to change single requests. A
// value; any thread.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/time.hpp"

namespace fieldcast {

using Slots = std::uint32_t;  // a number of slots, or the index of a slot in the table

struct TimetableMember {
  std::uint32_t first = 0, end = 1;  // its items
  std::uint32_t area = 0;            // for lists: one range reads items of one area only
  std::uint32_t bridge = 0;  // for lists: maximum distance of two points that share one range
  Duration range_cost{};     // for lists: wire time of another range of one item
  double item_ns = 0;        // wire time of another item of a range
  double fits = 1;           // base periods in its allowed gap
  Slots period = 1;          // from one reading to the next
  Slots phase = 0;           // slot of one reading, less than `period`
  friend bool operator==(const TimetableMember&, const TimetableMember&) = default;
};

struct TimetableRequest {
  bool list = false;      // a list of ranges; otherwise one range covers the due members
  Duration base_cost{};   // wire time without any item
  Slots period = 1;       // from one transmission to the next
  Slots phase = 0;        // slot of one transmission, less than `period`
  Duration latest_end{};  // latest end of its reads after the start of their slot
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
  // `slack`: how much earlier in its slot a read may end than the previous one.
  Timetable(Duration base_period, Duration slack)
      : base_period_(base_period), base_slack_(slack), slot_(base_period), slack_(slack) {}

  // This object becomes the variant whose slots end first; returns the others, in this order.
  std::vector<Timetable> fill(std::vector<TimetableRequest> requests, unsigned rounds);
  // Other requests keep their phases, as does this one if only its costs change. Then call align().
  void change(std::size_t index, TimetableRequest request);
  void align();

  [[nodiscard]] const TimetableRequest& request(std::size_t index) const {
    return requests_[index];
  }
  [[nodiscard]] Duration slot() const { return slot_; }
  // How much earlier a read may end than planned, per slot of its request's period.
  [[nodiscard]] Duration slack() const { return slack_; }
  [[nodiscard]] Duration hyperperiod() const { return slot_ * slots_; }
  [[nodiscard]] double load() const;                   // share of the wire
  [[nodiscard]] double load(std::size_t index) const;  // share of one request
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
                                   std::size_t extra = kNobody) const;
  void mark(std::size_t index, std::size_t member, Slots slot, bool due);
  void set_cost(std::size_t index, Slots slot, Duration cost);
  [[nodiscard]] double strain(std::size_t index, Slots slot, Duration cost) const;
  void enter(std::size_t index);
  void leave(std::size_t index);
  void place(std::size_t index, std::size_t member);
  void take_out(std::size_t index, std::size_t member);

  static constexpr std::size_t kNobody = ~std::size_t{0};
  Duration base_period_, base_slack_;
  Duration slot_, slack_;  // derived from the base values
  TableLength length_;
  Slots slots_ = 1;     // of the whole table
  Slots shortest_ = 1;  // of all requests' periods
  double level_slots_ = 0, level_steady_ = 0;
  std::vector<TimetableRequest> requests_;
  // By request: a bit per member, slot by slot.
  std::vector<std::vector<std::uint64_t>> due_;
  std::vector<Duration> cost_;    // of each request in each slot
  std::vector<Duration> total_;   // of each slot
  std::vector<Duration> steady_;  // of the most frequent requests in each slot
};

}  // namespace fieldcast
