// The timetable of a bus: the slots in which each request is sent, and the points that each
// transmission reads. Time is divided into slots: the base period of the bus, or a small part of
// it. The table repeats after its hyperperiod. A request is sent in every n-th slot; its slower
// points are read in every m-th slot.
//
// Phases are chosen for short reads (neighbours share the gap between them) and equal load of
// slots. Points are placed one by one, then each is placed again a few times. Within a slot
// requests have an order. Every read has a planned end: as soon as the wire allows, but not so
// early that the next read of one of its points would be too late. Keeps the data needed to change
// single requests. A value; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/time.hpp"
#include "core/plan/windows.hpp"

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
  bool list = false;     // a list of ranges; otherwise one range covers the due members
  bool nested = false;   // a member ends after a later one
  Duration base_cost{};  // wire time without any item
  Slots period = 1;      // from one transmission to the next
  Slots phase = 0;       // slot of one transmission, less than `period`
  // In a slot: how many of the most frequent requests are sent before it.
  std::uint32_t rank = 0;
  Duration latest_end{};  // of its reads, after the start of their slot
  std::vector<TimetableMember> members;
  friend bool operator==(const TimetableRequest&, const TimetableRequest&) = default;
};

struct TableLength {
  std::uint32_t parts = 1;  // slots in a base period
  Slots slots = 1;          // of the whole table
  friend bool operator==(const TableLength&, const TableLength&) = default;
};

// All for the fastest refresh of the bus.
struct TableTiming {
  Duration period{1};  // base period; less if the reads of a slot need less
  Duration gap{1};     // allowed gap: the longest time between two reads
  double reserve = 0;  // part of an allowed gap that the plan leaves unused, if it can
  friend bool operator==(const TableTiming&, const TableTiming&) = default;
};

class Timetable {
 public:
  explicit Timetable(const TableTiming& timing) : timing_(timing), slot_(timing.period) {}

  // This object becomes the variant with the largest reserve; returns the others, in this order.
  // `search`: for rounds of equal length, if the reserve is too small.
  std::vector<Timetable> fill(std::vector<TimetableRequest> requests, unsigned rounds,
                              bool search = true);
  // Changes the length of the slots; the reads in them stay.
  void set_period(Duration base_period);
  // Other requests keep their phases, as does this one if only its costs change. Then call align().
  void change(std::size_t index, TimetableRequest request);
  void align();

  [[nodiscard]] const TimetableRequest& request(std::size_t index) const {
    return requests_[index];
  }
  [[nodiscard]] Duration slot() const { return slot_; }
  // Of each read, by slot, from the start of the table; zero in slots without a read.
  [[nodiscard]] std::span<const Duration> ends(std::size_t index) const {
    return std::span(ends_).subspan(index * slots_, slots_);
  }
  // The last planned end up to `until`, in slots phase, phase + period, .. Both times count from
  // the start of the table, which repeats in both directions.
  [[nodiscard]] Duration last_end(std::size_t index, Slots phase, Slots period,
                                  Duration until) const;
  // The longest planned time between two reads of the member.
  [[nodiscard]] Duration longest_gap(std::size_t index, const TimetableMember& member) const {
    return longest_gap(index, member, ends_, hyperperiod());
  }
  // How much earlier than planned reads of the request may end, at most `most`, so that no gap to
  // the next read is too long.
  [[nodiscard]] Duration slack(std::size_t index, Duration most) const;
  // Smallest part of an allowed gap that is left if the wire never rests; negative if a gap of the
  // plan is too long.
  [[nodiscard]] double spare() const { return spare_; }
  [[nodiscard]] Duration hyperperiod() const { return slot_ * slots_; }
  [[nodiscard]] double load() const;                   // share of the wire
  [[nodiscard]] double load(std::size_t index) const;  // share of one request
  [[nodiscard]] bool empty() const;                    // no request has members

  friend bool operator==(const Timetable&, const Timetable&) = default;

 private:
  void choose_length();
  void settle(unsigned rounds);
  void sort_by_reserve(std::vector<Timetable>& ways) const;
  void improve_all(std::vector<Timetable>& ways) const;
  unsigned improve(unsigned passes);
  bool kick(std::uint32_t& random);
  void start_rounds();
  bool move_in_order(std::size_t index);
  bool move_in_table(std::size_t index);
  void set_ranks();
  [[nodiscard]] std::vector<std::size_t> order() const;
  [[nodiscard]] Duration allowed(const TimetableMember& member, double reserve) const;
  [[nodiscard]] Duration longest_gap(std::size_t index, const TimetableMember& member,
                                     std::span<const Duration> ends, Duration length) const;
  [[nodiscard]] double spare(std::span<const Duration> ends, Duration length) const;
  [[nodiscard]] double spare_without_rests(std::span<const std::size_t> order) const;
  bool wait_for_next(std::span<const std::size_t> order, double reserve);
  void set_latest_end(std::size_t index);
  [[nodiscard]] Duration latest_end() const;
  [[nodiscard]] Duration& cost(std::size_t index, Slots slot) {
    return cost_[index * slots_ + slot];
  }
  [[nodiscard]] Duration cost(std::size_t index, Slots slot) const {
    return cost_[index * slots_ + slot];
  }
  [[nodiscard]] bool frequent(std::size_t index) const {
    return !requests_[index].members.empty() && requests_[index].period == shortest_;
  }
  [[nodiscard]] Duration read_cost(std::size_t index, Slots slot,
                                   std::size_t extra = kNobody) const;
  void mark(std::size_t index, std::size_t member, Slots slot, bool due);
  void set_cost(std::size_t index, Slots slot, Duration cost);
  [[nodiscard]] double strain(std::size_t index, Slots slot, Duration cost) const;
  void enter(std::size_t index);
  void leave(std::size_t index);
  void place(std::size_t index, std::size_t member, Slots first);
  void put(std::size_t index, std::size_t member, Slots phase);
  void take_out(std::size_t index, std::size_t member);

  static constexpr std::size_t kNobody = ~std::size_t{0};
  TableTiming timing_;
  Duration slot_;  // derived from the timing
  TableLength length_;
  Slots slots_ = 1;     // of the whole table
  Slots shortest_ = 1;  // of all requests' periods
  double level_slots_ = 0, level_steady_ = 0;
  double spare_ = 0;
  std::vector<TimetableRequest> requests_;
  // By request: a bit per member, slot by slot.
  std::vector<std::vector<std::uint64_t>> due_;
  std::vector<Duration> cost_;      // of each request in each slot
  std::vector<Duration> ends_;      // of each read, from the start of the table
  std::vector<Duration> total_;     // of each slot
  std::vector<Duration> steady_;    // of the most frequent requests in each slot
  std::optional<Windows> windows_;  // only while phases are improved
};

}  // namespace fieldcast
