#include "core/plan/windows.hpp"

#include <algorithm>

namespace fieldcast {

Windows::Windows(std::uint32_t frequent, std::uint32_t slots, Duration slot)
    : frequent_(frequent), slots_(slots), lengths_(std::size_t{frequent} * slots) {
  constexpr std::int64_t kResolution = std::int64_t{1} << 20;
  while (slot.count() >> shift_ > kResolution) ++shift_;
}

void Windows::change(std::uint32_t rank, std::uint32_t slot, Duration before, Duration now) {
  const std::int64_t more = units(now) - units(before);
  std::int64_t* const begins = row(slot);
  std::int64_t* const ends = row(previous(slot));
  for (std::uint32_t at = 0; at < rank; ++at) begins[at] += more;
  for (std::uint32_t at = rank; at < frequent_; ++at) ends[at] += more;
}

std::int64_t Windows::strain(std::uint32_t rank, std::uint32_t slot, Duration before,
                             Duration now) const {
  const std::int64_t more = units(now) - units(before);
  const std::int64_t* const begins = row(slot);
  const std::int64_t* const ends = row(previous(slot));
  std::int64_t sum = 0;
  for (std::uint32_t at = 0; at < rank; ++at) sum += growth(begins[at], more);
  for (std::uint32_t at = rank; at < frequent_; ++at) sum += growth(ends[at], more);
  return sum;
}

void Windows::add_strains(std::uint32_t slot, Duration now, std::span<std::int64_t> sums) const {
  const std::int64_t more = units(now);
  const std::int64_t* const begins = row(slot);
  const std::int64_t* const ends = row(previous(slot));
  std::int64_t first = 0, beyond_first = 0;  // of rank 0, and what the rank adds to it
  for (std::uint32_t at = 0; at < frequent_; ++at) {
    const std::int64_t ends_here = growth(ends[at], more);
    first += ends_here;
    beyond_first += growth(begins[at], more) - ends_here;
    sums[at + 1] += beyond_first;
  }
  for (std::int64_t& sum : sums) sum += first;
}

Duration Windows::longest() const {
  return Duration{*std::ranges::max_element(lengths_) << shift_};
}

std::int64_t Windows::exchange(std::uint32_t rank, std::span<const Duration> first,
                               std::span<const Duration> second) {
  const auto squares = [&] {
    std::int64_t sum = 0;
    for (std::uint32_t slot = 0; slot < slots_; ++slot) {
      const std::int64_t more = over(row(slot)[rank]);
      sum += more * more;
    }
    return sum;
  };
  const std::int64_t before = squares();
  for (std::uint32_t slot = 0; slot < slots_; ++slot) {
    const std::int64_t later = units(second[slot]) - units(first[slot]);
    row(slot)[rank] -= later;
    row(previous(slot))[rank] += later;
  }
  return squares() - before;
}

}  // namespace fieldcast
