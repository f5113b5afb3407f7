// Rounds of the most frequent requests of a timetable. A *round* is the time from the end of such a
// request to its end in the next slot: all reads between the two, without rests. No rest can make
// it shorter, so it must not exceed the allowed gap. The phases and the order of requests are
// improved for rounds of equal length. Integers only, for the same plan on every machine.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/time.hpp"

namespace fieldcast {

class Windows {
 public:
  // `slot`: an upper limit of most rounds, for the resolution.
  Windows(std::uint32_t frequent, std::uint32_t slots, Duration slot);

  [[nodiscard]] std::uint32_t frequent() const { return frequent_; }
  // The strain is the sum of the squares of what rounds exceed this length by.
  void set_goal(Duration length) { goal_ = units(length); }
  // The read of a request in `slot` lasts `now` instead of `before`. `rank`: the number of frequent
  // requests before it in the slot; it is part of rounds of these that begin in the slot, and of
  // rounds of the others that end there.
  void change(std::uint32_t rank, std::uint32_t slot, Duration before, Duration now);
  // What change() would add to the strain.
  [[nodiscard]] std::int64_t strain(std::uint32_t rank, std::uint32_t slot, Duration before,
                                    Duration now) const;
  // The same for every rank of a new read; adds to sums[0 .. frequent].
  void add_strains(std::uint32_t slot, Duration now, std::span<std::int64_t> sums) const;
  [[nodiscard]] Duration longest() const;
  // Exchanges the frequent requests `rank` and `rank` + 1, whose reads last `first` and `second` by
  // slot. Returns what this adds to the strain.
  std::int64_t exchange(std::uint32_t rank, std::span<const Duration> first,
                        std::span<const Duration> second);

  friend bool operator==(const Windows&, const Windows&) = default;

 private:
  [[nodiscard]] std::int64_t units(Duration length) const { return length.count() >> shift_; }
  [[nodiscard]] const std::int64_t* row(std::uint32_t slot) const {
    return lengths_.data() + std::size_t{slot} * frequent_;
  }
  [[nodiscard]] std::int64_t* row(std::uint32_t slot) {
    return lengths_.data() + std::size_t{slot} * frequent_;
  }
  [[nodiscard]] std::uint32_t previous(std::uint32_t slot) const {
    return slot == 0 ? slots_ - 1 : slot - 1;
  }
  [[nodiscard]] std::int64_t over(std::int64_t length) const {
    return std::max(length - goal_, std::int64_t{0});
  }
  // Of the square of what exceeds the goal.
  [[nodiscard]] std::int64_t growth(std::int64_t length, std::int64_t more) const {
    const std::int64_t before = over(length), now = over(length + more);
    return (now - before) * (now + before);
  }

  std::uint32_t frequent_, slots_;
  int shift_ = 0;
  std::int64_t goal_ = 0;
  std::vector<std::int64_t> lengths_;  // by slot of the beginning, and rank
};

}  // namespace fieldcast
