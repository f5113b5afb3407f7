// The order of requests within a slot, the planned ends of their reads, and the search for rounds
// of equal length (windows.hpp).
#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/plan/layout/time_math.hpp"
#include "core/plan/timetable.hpp"

namespace fieldcast {

// The most frequent requests are first; among them, those whose reads change least.
void Timetable::set_ranks() {
  std::vector<std::size_t> order;
  for (std::size_t index = 0; index < requests_.size(); ++index) {
    if (frequent(index)) order.push_back(index);
  }
  std::ranges::stable_sort(order, {}, [&](std::size_t index) {
    const TimetableRequest& request = requests_[index];
    return std::ranges::count_if(request.members,
                                 [&](const auto& m) { return m.period > request.period; });
  });
  const auto count = static_cast<std::uint32_t>(order.size());
  for (TimetableRequest& request : requests_) request.rank = count;
  for (std::uint32_t rank = 0; rank < count; ++rank) requests_[order[rank]].rank = rank;
}

std::vector<std::size_t> Timetable::order() const {
  std::vector<std::size_t> order(requests_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t index) {
    return std::tuple(requests_[index].rank, frequent(index), requests_[index].period);
  });
  return order;
}

Duration Timetable::allowed(const TimetableMember& member, double reserve) const {
  return Duration{static_cast<Duration::rep>(member.fits * ns(timing_.gap) * (1 - reserve))};
}

// `ends`: of every read, from the start of a table of the given length.
Duration Timetable::longest_gap(std::size_t index, const TimetableMember& member,
                                std::span<const Duration> ends, Duration length) const {
  Duration longest{};
  const std::size_t row = index * slots_;
  for (Slots slot = member.phase; slot < slots_; slot += member.period) {
    const Slots next = slot + member.period;
    longest =
        std::max(longest, ends[row + next % slots_] + next / slots_ * length - ends[row + slot]);
  }
  return longest;
}

Duration Timetable::slack(std::size_t index, Duration most) const {
  for (const TimetableMember& member : requests_[index].members)
    most = std::min(most, allowed(member, timing_.reserve) - longest_gap(index, member));
  return std::max(Duration::zero(), most);
}

// The smallest part of an allowed gap that is left.
double Timetable::spare(std::span<const Duration> ends, Duration length) const {
  double least = 1;
  for (std::size_t index = 0; index < requests_.size(); ++index) {
    for (const TimetableMember& member : requests_[index].members) {
      const Duration gap = longest_gap(index, member, ends, length);
      least = std::min(least, 1 - ns(gap) / ns(allowed(member, 0)));
    }
  }
  return least;
}

// As if the wire never rested: no rest can make a gap shorter.
double Timetable::spare_without_rests(std::span<const std::size_t> order) const {
  std::vector<Duration> ends(cost_.size());
  Duration now{};
  for (Slots slot = 0; slot < slots_; ++slot) {
    for (const std::size_t index : order) ends[index * slots_ + slot] = now += cost(index, slot);
  }
  return spare(ends, now);
}

// Each read waits for the start of its slot and for the reads before it. Where the next read of a
// point would be too late, it waits longer. Repeats until nothing changes.
void Timetable::align() {
  constexpr int kMostPasses = 64;
  const std::vector<std::size_t> order = this->order();
  spare_ = spare_without_rests(order);
  const double margin = 1 - ns(slot_) * length_.parts / ns(timing_.gap);
  const double reserve = std::min({timing_.reserve, spare_, margin / 2});
  ends_.assign(cost_.size(), Duration::zero());
  Duration before{std::numeric_limits<Duration::rep>::min() / 2};  // end of the last read
  bool moved = true;
  for (int pass = 0; moved && pass < kMostPasses; ++pass) {
    moved = false;
    for (Slots slot = 0; slot < slots_; ++slot) {
      before = std::max(before, slot_ * slot);
      for (const std::size_t index : order) {
        if (cost(index, slot) == Duration::zero()) continue;
        Duration& end = ends_[index * slots_ + slot];
        before = std::max(end, before + cost(index, slot));
        moved = moved || end != before;
        end = before;
      }
    }
    before -= hyperperiod();
    moved = wait_for_next(order, reserve) || moved;
  }
  for (std::size_t index = 0; index < requests_.size(); ++index) set_latest_end(index);
}

// Returns true if a read waits longer.
bool Timetable::wait_for_next(std::span<const std::size_t> order, double reserve) {
  bool moved = false;
  for (const std::size_t index : order) {
    Duration* const ends = ends_.data() + index * slots_;
    for (const TimetableMember& member : requests_[index].members) {
      const Duration gap = allowed(member, reserve);
      for (Slots read = (slots_ - 1 - member.phase) / member.period + 1; read-- > 0;) {
        const Slots slot = member.phase + read * member.period;
        const Slots next = slot + member.period;
        const Duration least = ends[next % slots_] + next / slots_ * hyperperiod() - gap;
        if (least <= ends[slot]) continue;
        ends[slot] = least;
        moved = true;
      }
    }
  }
  return moved;
}

void Timetable::set_latest_end(std::size_t index) {
  TimetableRequest& request = requests_[index];
  request.latest_end = Duration::zero();
  for (Slots slot = request.phase; slot < slots_; slot += request.period) {
    if (cost(index, slot) == Duration::zero()) continue;
    const Duration end = ends_[index * slots_ + slot] - slot_ * slot;
    request.latest_end = std::max(request.latest_end, end);
  }
}

void Timetable::set_period(Duration base_period) {
  timing_.period = base_period;
  slot_ = std::max(Duration{1}, base_period / length_.parts);
  align();
}

Duration Timetable::last_end(std::size_t index, Slots phase, Slots period, Duration until) const {
  const Duration step = slot_ * period;
  const Duration start = until - since_phase(Instant{until}, Instant{slot_ * phase}, step);
  // No read ends before the start of its slot.
  for (auto slot = start / slot_;; slot -= period) {
    const auto in_table = (slot % slots_ + slots_) % slots_;
    const Duration end =
        ends_[index * slots_ + static_cast<std::size_t>(in_table)] + (slot - in_table) * slot_;
    if (end <= until) return end;
  }
}

Duration Timetable::latest_end() const {
  Duration latest{};
  for (const TimetableRequest& request : requests_) latest = std::max(latest, request.latest_end);
  return latest;
}

void Timetable::sort_by_reserve(std::vector<Timetable>& ways) const {
  std::ranges::stable_sort(ways, {}, [&](const Timetable& way) {
    return std::pair(-std::min(way.spare_, timing_.reserve), way.latest_end());
  });
}

namespace {

// Limits the time of a search: members, times the reads of the table, times passes. A plan of 300
// points takes about a second.
constexpr std::size_t kMostEffort = 500'000'000;
constexpr unsigned kPasses = 20, kMostPasses = 600;  // of a way, and in all
// When nothing moves any more, only rounds in the longest three quarters, then half, still count.
constexpr int kGoals = 2;
// One of so many slower members is moved anywhere before the best plan is improved again.
constexpr unsigned kKicked = 20;

// A number below `count`, the same on every machine (Park, Miller, Stockmeyer 1993).
std::uint32_t any(std::uint32_t& random, std::uint32_t count) {
  random = static_cast<std::uint32_t>(std::uint64_t{48'271} * random % 2'147'483'647);
  return random % count;
}

}  // namespace

// Improves each way, then the best one again from other places.
void Timetable::improve_all(std::vector<Timetable>& ways) const {
  std::size_t members = 0;
  for (const TimetableRequest& request : requests_) members += request.members.size();
  const auto most_passes = static_cast<unsigned>(std::min<std::size_t>(
      kMostPasses, kMostEffort / std::max<std::size_t>(1, members * cost_.size())));
  unsigned passes = 0;
  for (Timetable& way : ways) {
    passes += way.improve(std::min(kPasses, most_passes - passes));
    if (way.spare_ >= timing_.reserve) break;
  }
  sort_by_reserve(ways);
  std::uint32_t random = 1;
  while (passes < most_passes && ways.front().spare_ < timing_.reserve) {
    Timetable other = ways.front();
    if (!other.kick(random)) break;
    passes += other.improve(std::min(kPasses, most_passes - passes)) + 1;
    if (other.spare_ > ways.front().spare_) ways.front() = std::move(other);
  }
}

// Moves some slower members to any phase. Returns false if there is none.
bool Timetable::kick(std::uint32_t& random) {
  bool any_slower = false;
  for (std::size_t index = 0; index < requests_.size(); ++index) {
    const TimetableRequest& request = requests_[index];
    for (std::size_t which = 0; which < request.members.size(); ++which) {
      const Slots period = std::min(request.members[which].period, slots_);
      if (period == request.period) continue;
      any_slower = true;
      if (any(random, kKicked) != 0) continue;
      const Slots choice = any(random, period / request.period);
      take_out(index, which);
      put(index, which, request.phase + request.period * choice);
    }
  }
  spare_ = spare_without_rests(order());
  return any_slower;
}

// Moves requests and members, one by one, to the phase and the place in the slot with the least
// strain. Keeps the best of all passes; returns their number.
unsigned Timetable::improve(unsigned passes) {
  Timetable best = *this;
  start_rounds();
  int goal = 0;
  unsigned pass = 0;
  for (; pass < passes && best.spare_ < timing_.reserve; ++pass) {
    const Duration mean = std::accumulate(total_.begin(), total_.end(), Duration::zero()) / slots_;
    windows_->set_goal(mean + (windows_->longest() - mean) / 4 * goal);
    bool moved = false;
    for (std::size_t index = 0; index < requests_.size(); ++index) {
      if (requests_[index].members.empty()) continue;
      moved = (frequent(index) ? move_in_order(index) : move_in_table(index)) || moved;
      for (std::size_t member = 0; member < requests_[index].members.size(); ++member) {
        const TimetableMember& moving = requests_[index].members[member];
        if (moving.period == requests_[index].period) continue;
        const Slots phase = moving.phase;
        take_out(index, member);
        place(index, member, phase);
        moved = moved || moving.phase != phase;
      }
    }
    spare_ = spare_without_rests(order());
    if (spare_ > best.spare_) best = *this;
    if (!moved && ++goal > kGoals) break;
  }
  *this = std::move(best);
  windows_.reset();
  align();
  return pass;
}

void Timetable::start_rounds() {
  std::uint32_t frequents = 0;
  for (std::size_t index = 0; index < requests_.size(); ++index) frequents += frequent(index);
  windows_.emplace(frequents, slots_, slot_);
  for (std::size_t index = 0; index < requests_.size(); ++index) {
    for (Slots slot = 0; slot < slots_; ++slot)
      windows_->change(requests_[index].rank, slot, Duration::zero(), cost(index, slot));
  }
}

// A frequent request: another place among the frequent ones.
bool Timetable::move_in_order(std::size_t index) {
  std::vector<std::size_t> at;  // frequent requests by rank
  for (std::size_t i = 0; i < requests_.size(); ++i) {
    if (frequent(i)) at.push_back(i);
  }
  std::ranges::sort(at, {}, [&](std::size_t i) { return requests_[i].rank; });
  const auto costs = [&](std::size_t i) { return std::span(cost_).subspan(i * slots_, slots_); };
  std::int64_t strain = 0, least = 0;
  const std::uint32_t from = requests_[index].rank;
  std::uint32_t now = from, best = from;
  const auto step_to = [&](std::uint32_t rank) {
    const std::uint32_t low = std::min(now, rank);
    strain += windows_->exchange(low, costs(at[low]), costs(at[low + 1]));
    std::swap(at[low], at[low + 1]);
    now = rank;
    if (strain < least) least = strain, best = rank;
  };
  while (now + 1 < at.size()) step_to(now + 1);
  while (now > 0) step_to(now - 1);
  while (now != best) step_to(now + 1);
  for (std::uint32_t rank = 0; rank < at.size(); ++rank) requests_[at[rank]].rank = rank;
  return best != from;
}

// A slower request: another phase, its members included, and another place in the slot.
bool Timetable::move_in_table(std::size_t index) {
  TimetableRequest& request = requests_[index];
  const std::vector<Duration> costs(
      cost_.begin() + static_cast<std::ptrdiff_t>(index * slots_),
      cost_.begin() + static_cast<std::ptrdiff_t>((index + 1) * slots_));
  Slots shifts = 1;
  for (const TimetableMember& member : request.members)
    shifts = std::max(shifts, std::min(member.period, slots_));
  std::vector<Slots> reads;  // the most expensive first, as they decide soonest
  for (Slots slot = 0; slot < slots_; ++slot) {
    if (costs[slot] != Duration::zero()) reads.push_back(slot);
  }
  std::ranges::stable_sort(reads, std::greater{}, [&](Slots slot) { return costs[slot]; });
  leave(index);
  std::vector<std::int64_t> sums(windows_->frequent() + 1);
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  Slots best_shift = 0;
  std::uint32_t best_rank = request.rank;
  for (Slots shift = 0; shift < shifts; ++shift) {
    std::ranges::fill(sums, 0);
    for (const Slots slot : reads) {
      windows_->add_strains((slot + shift) % slots_, costs[slot], sums);
      if (std::ranges::min(sums) >= least) break;  // sums only grow
    }
    if (shift == 0) least = sums[request.rank];
    for (std::uint32_t rank = 0; rank < sums.size(); ++rank) {
      if (sums[rank] < least) least = sums[rank], best_shift = shift, best_rank = rank;
    }
  }
  const bool moved = best_shift != 0 || best_rank != request.rank;
  request.rank = best_rank;
  request.phase = (request.phase + best_shift) % request.period;
  for (TimetableMember& member : request.members)
    member.phase = (member.phase + best_shift) % std::min(member.period, slots_);
  const auto words = static_cast<std::ptrdiff_t>(due_[index].size() / slots_);
  std::rotate(due_[index].begin(), due_[index].end() - words * best_shift, due_[index].end());
  for (Slots slot = 0; slot < slots_; ++slot)
    set_cost(index, (slot + best_shift) % slots_, costs[slot]);
  return moved;
}

}  // namespace fieldcast
