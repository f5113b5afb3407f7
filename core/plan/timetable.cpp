#include "core/plan/timetable.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <numeric>
#include <utility>

#include "core/plan/layout/time_math.hpp"
#include "core/plan/table_length.hpp"

namespace fieldcast {

namespace {

// Weights for the choice of a phase, relative to wire time: equal load of slots, and equal load of
// the most frequent requests, which are the least flexible. Found by measurement. No set is best
// for every bus, so each is tried.
struct Levels {
  double slots, steady;
};
constexpr std::array<Levels, 8> kLevels{
    {{4, 8}, {1, 3}, {2, 8}, {6, 6}, {8, 16}, {3, 3}, {12, 8}, {4, 20}}};

std::size_t words_for(std::size_t members) { return (members + 63) / 64; }

void prepare(TimetableRequest& request, const TableLength& length) {
  set_periods(request, length);
  request.nested = !std::ranges::is_sorted(request.members, {}, &TimetableMember::end);
}

double growth(Duration before, double more) { return more * (2.0 * ns(before) + more); }

// Wire time of one range from the first due member to the last one.
template <typename DueIn>
Duration range_cost(const TimetableRequest& request, std::size_t words, const DueIn& due_in) {
  std::size_t first = 0;
  while (first < words && due_in(first) == 0) ++first;
  if (first == words) return Duration::zero();
  std::size_t last = words - 1;
  while (due_in(last) == 0) --last;
  const TimetableMember& begin =
      request.members[first * 64 + static_cast<std::size_t>(std::countr_zero(due_in(first)))];
  const TimetableMember& end =
      request.members[last * 64 + 63 - static_cast<std::size_t>(std::countl_zero(due_in(last)))];
  return request.base_cost +
         Duration{static_cast<Duration::rep>(begin.item_ns * (end.end - begin.first))};
}

}  // namespace

void Timetable::choose_length() {
  length_ = table_length(requests_);
  slots_ = length_.slots;
  slot_ = std::max(Duration{1}, timing_.period / length_.parts);
  for (TimetableRequest& request : requests_) prepare(request, length_);
  shortest_ = slots_;
  for (const TimetableRequest& request : requests_) {
    if (!request.members.empty()) shortest_ = std::min(shortest_, request.period);
  }
}

// Wire time of the due members and of member `extra`.
Duration Timetable::read_cost(std::size_t index, Slots slot, std::size_t extra) const {
  const TimetableRequest& request = requests_[index];
  const std::size_t words = words_for(request.members.size());
  const std::uint64_t* const due = due_[index].data() + slot * words;
  const auto due_in = [&](std::size_t word) {
    return extra / 64 == word ? due[word] | std::uint64_t{1} << extra % 64 : due[word];
  };
  if (!request.list && !request.nested) return range_cost(request, words, due_in);
  const TimetableMember* range = nullptr;  // first member of the range
  std::uint32_t end = 0;
  double sum = 0;
  for (std::size_t word = 0; word < words; ++word) {
    for (std::uint64_t left = due_in(word); left != 0; left &= left - 1) {
      const TimetableMember& member =
          request.members[word * 64 + static_cast<std::size_t>(std::countr_zero(left))];
      const bool joins =
          range != nullptr &&
          (!request.list || (member.area == range->area && member.first <= end + member.bridge));
      if (!joins) {
        sum += ns(member.range_cost) - member.item_ns;
        range = &member;
        end = member.first;
      }
      if (member.end <= end) continue;
      sum += member.item_ns * (member.end - end);
      end = member.end;
    }
  }
  if (range == nullptr) return Duration::zero();
  return request.base_cost + Duration{static_cast<Duration::rep>(sum)};
}

void Timetable::mark(std::size_t index, std::size_t member, Slots slot, bool due) {
  std::uint64_t& word =
      due_[index][slot * words_for(requests_[index].members.size()) + member / 64];
  const std::uint64_t bit = std::uint64_t{1} << member % 64;
  word = due ? word | bit : word & ~bit;
}

void Timetable::set_cost(std::size_t index, Slots slot, Duration cost) {
  Duration& now = this->cost(index, slot);
  if (now == cost) return;
  if (windows_) windows_->change(requests_[index].rank, slot, now, cost);
  total_[slot] += cost - now;
  if (requests_[index].period == shortest_) steady_[slot] += cost - now;
  now = cost;
}

double Timetable::strain(std::size_t index, Slots slot, Duration cost) const {
  const Duration now = this->cost(index, slot);
  if (cost == now) return 0;
  if (windows_)
    return static_cast<double>(windows_->strain(requests_[index].rank, slot, now, cost));
  const double more = ns(cost - now);
  const double steady =
      requests_[index].period == shortest_ ? level_steady_ * growth(steady_[slot], more) : 0;
  return more + (level_slots_ * growth(total_[slot], more) + steady) / ns(slot_);
}

// Chooses the phase of the least strain; among equals, `first` or the smallest one.
void Timetable::place(std::size_t index, std::size_t which, Slots first) {
  const TimetableRequest& request = requests_[index];
  const Slots period = request.members[which].period;
  const auto sum_at = [&](Slots phase, double limit) {
    double sum = 0;
    for (Slots slot = phase; slot < slots_ && sum < limit; slot += period)
      sum += strain(index, slot, read_cost(index, slot, which));
    return sum;
  };
  Slots best = first;
  double least = sum_at(first, std::numeric_limits<double>::infinity());
  for (Slots phase = request.phase; phase < std::min(period, slots_) && least > 0;
       phase += request.period) {
    const double sum = phase == first ? least : sum_at(phase, least);
    if (sum < least) least = sum, best = phase;
  }
  put(index, which, best);
}

void Timetable::put(std::size_t index, std::size_t which, Slots phase) {
  TimetableMember& member = requests_[index].members[which];
  member.phase = phase;
  for (Slots slot = phase; slot < slots_; slot += member.period) {
    mark(index, which, slot, true);
    set_cost(index, slot, read_cost(index, slot));
  }
}

void Timetable::take_out(std::size_t index, std::size_t which) {
  TimetableMember& member = requests_[index].members[which];
  for (Slots slot = std::exchange(member.phase, ~0u); slot < slots_; slot += member.period) {
    mark(index, which, slot, false);
    set_cost(index, slot, read_cost(index, slot));
  }
}

// Selects the least loaded phase, then places the members from the fastest to the slowest.
void Timetable::enter(std::size_t index) {
  TimetableRequest& request = requests_[index];
  Duration least{};
  for (Slots phase = 0; phase < request.period; ++phase) {
    Duration sum{};
    for (Slots slot = phase; slot < slots_; slot += request.period) sum += total_[slot];
    if (phase == 0 || sum < least) least = sum, request.phase = phase;
  }
  due_[index].assign(words_for(request.members.size()) * slots_, 0);
  std::vector<std::size_t> order;
  for (std::size_t which = 0; which < request.members.size(); ++which) {
    TimetableMember& member = request.members[which];
    member.phase = member.period == request.period ? request.phase : ~0u;
    if (member.phase == ~0u) {
      order.push_back(which);
      continue;
    }
    for (Slots slot = request.phase; slot < slots_; slot += request.period)
      mark(index, which, slot, true);
  }
  for (Slots slot = request.phase; slot < slots_; slot += request.period)
    set_cost(index, slot, read_cost(index, slot));
  std::ranges::stable_sort(order, {},
                           [&](std::size_t which) { return request.members[which].period; });
  for (const std::size_t which : order) place(index, which, request.phase);
}

void Timetable::leave(std::size_t index) {
  for (Slots slot = 0; slot < slots_; ++slot) set_cost(index, slot, Duration::zero());
}

std::vector<Timetable> Timetable::fill(std::vector<TimetableRequest> requests, unsigned rounds,
                                       bool search) {
  constexpr std::size_t kLarge = 8'000;  // reads in the table above which it is made only once
  requests_ = std::move(requests);
  choose_length();
  set_ranks();
  std::vector<Timetable> ways;
  for (const Levels& levels : kLevels) {
    level_slots_ = levels.slots;
    level_steady_ = levels.steady;
    settle(rounds);
    ways.push_back(*this);
    if (cost_.size() > kLarge) break;
  }
  sort_by_reserve(ways);
  if (search && rounds > 0 && ways.front().spare_ < timing_.reserve) improve_all(ways);
  *this = std::move(ways.front());
  ways.erase(ways.begin());
  return ways;
}

bool Timetable::empty() const {
  return std::ranges::all_of(requests_,
                             [](const auto& request) { return request.members.empty(); });
}

void Timetable::settle(unsigned rounds) {
  cost_.assign(requests_.size() * slots_, Duration::zero());
  total_.assign(slots_, Duration::zero());
  steady_.assign(slots_, Duration::zero());
  due_.assign(requests_.size(), {});
  std::vector<std::size_t> order(requests_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return requests_[a].period < requests_[b].period;
  });
  for (const std::size_t index : order) enter(index);
  for (unsigned round = 0; round < rounds; ++round) {
    for (const std::size_t index : order) {
      if (requests_[index].period > shortest_) {
        leave(index);
        enter(index);
        continue;
      }
      for (std::size_t member = 0; member < requests_[index].members.size(); ++member) {
        if (requests_[index].members[member].period == requests_[index].period) continue;
        take_out(index, member);
        place(index, member, requests_[index].phase);
      }
    }
  }
  align();
}

void Timetable::change(std::size_t index, TimetableRequest request) {
  prepare(request, length_);
  TimetableRequest& before = requests_[index];
  request.rank = before.rank;
  const bool same =
      request.period == before.period &&
      std::equal(request.members.begin(), request.members.end(), before.members.begin(),
                 before.members.end(), [](const TimetableMember& a, const TimetableMember& b) {
                   return a.first == b.first && a.end == b.end && a.area == b.area &&
                          a.period == b.period;
                 });
  if (same) {
    request.phase = before.phase;
    for (std::size_t i = 0; i < request.members.size(); ++i)
      request.members[i].phase = before.members[i].phase;
    before = std::move(request);
    for (Slots slot = before.phase; slot < slots_; slot += before.period)
      set_cost(index, slot, read_cost(index, slot));
  } else {
    leave(index);
    before = std::move(request);
    if (!before.members.empty()) enter(index);
  }
}

double Timetable::load() const {
  const Duration sum = std::accumulate(total_.begin(), total_.end(), Duration::zero());
  return ns(sum) / (ns(slot_) * slots_);
}

double Timetable::load(std::size_t index) const {
  Duration sum{};
  for (Slots slot = 0; slot < slots_; ++slot) sum += cost_[index * slots_ + slot];
  return ns(sum) / (ns(slot_) * slots_);
}

}  // namespace fieldcast
