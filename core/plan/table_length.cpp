#include "core/plan/table_length.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "core/plan/layout/time_math.hpp"

namespace fieldcast {

namespace {

// Lengths with many divisors, and parts of a base period: 2.5 base periods are 5 halves.
constexpr std::array<std::uint32_t, 36> kLengths{1,  2,  3,  4,  5,  6,  7,  8,  9,  10,  11,  12,
                                                 13, 14, 15, 16, 18, 20, 22, 24, 26, 30,  33,  36,
                                                 40, 44, 48, 52, 60, 66, 72, 80, 84, 100, 120, 140};
constexpr std::array<std::uint32_t, 6> kParts{1, 2, 3, 4, 5, 6};
constexpr double kWorthALength = 0.9999, kWorthParts = 0.98;

class Divisors {
 public:
  constexpr Divisors() {
    for (std::uint32_t n = 1; n <= kMost; ++n) {
      for (std::uint32_t limit = 1; limit <= n; ++limit)
        greatest_[n][limit] =
            n % limit == 0 ? static_cast<std::uint8_t>(limit) : greatest_[n][limit - 1];
    }
  }
  [[nodiscard]] std::uint32_t of(std::uint32_t n, std::uint32_t limit) const {
    return greatest_[n][limit];
  }

 private:
  static constexpr std::uint32_t kMost = kLengths.back();
  std::array<std::array<std::uint8_t, kMost + 1>, kMost + 1> greatest_{};
};
constexpr Divisors kDivisors;

// The period divides a table of `slots`. REQUIRES: step divides slots.
Slots period_within(Slots usable, Slots step, Slots slots) {
  if (usable >= slots) return usable / slots * slots;
  return step * kDivisors.of(slots / step, std::max(usable / step, 1u));
}

Slots slots_in(const TimetableMember& member, std::uint32_t parts) {
  return static_cast<Slots>(std::clamp(member.fits * parts + 0.001, 1.0, 1e9));
}

Slots period_of(const TimetableRequest& request, const TableLength& length) {
  Slots own = ~0u;
  for (const TimetableMember& member : request.members)
    own = std::min(own, slots_in(member, length.parts));
  return own >= length.slots ? length.slots : period_within(own, 1, length.slots);
}

// Wire time per base period, without the gaps between points.
double spent(std::span<const TimetableRequest> requests, const TableLength& length) {
  double sum = 0;
  for (const TimetableRequest& request : requests) {
    const Slots period = period_of(request, length);
    sum += ns(request.base_cost) / period;
    for (const TimetableMember& member : request.members) {
      const Slots own = period_within(slots_in(member, length.parts), period, length.slots);
      sum += member.item_ns * (member.end - member.first) / std::min(length.slots, own);
    }
  }
  return sum * length.parts;
}

}  // namespace

TableLength table_length(std::span<const TimetableRequest> requests) {
  constexpr std::size_t kMany = 2000;  // members above which a long table takes too much time
  std::size_t members = 0;
  for (const TimetableRequest& request : requests) members += request.members.size();
  TableLength chosen;
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t parts : kParts) {
    double best = std::numeric_limits<double>::infinity();
    TableLength length{parts, 1};
    for (const Slots slots : kLengths) {
      if (slots > 100 && members > kMany) break;
      const double now = spent(requests, {parts, slots});
      if (now < kWorthALength * best) best = now, length.slots = slots;
    }
    if (best < kWorthParts * least) least = best, chosen = length;
  }
  return chosen;
}

void set_periods(TimetableRequest& request, const TableLength& length) {
  request.period = period_of(request, length);
  for (TimetableMember& member : request.members)
    member.period = period_within(slots_in(member, length.parts), request.period, length.slots);
}

}  // namespace fieldcast
