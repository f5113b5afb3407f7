#include "core/schedule/timetable.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

namespace fieldcast {

namespace {

// Lengths that many numbers divide, and parts of a beat that make other numbers whole: 2.5 beats
// are 5 halves.
constexpr std::array<std::uint32_t, 36> kLengths{1,  2,  3,  4,  5,  6,  7,  8,  9,  10,  11,  12,
                                                 13, 14, 15, 16, 18, 20, 22, 24, 26, 30,  33,  36,
                                                 40, 44, 48, 52, 60, 66, 72, 80, 84, 100, 120, 140};
constexpr std::array<std::uint32_t, 6> kParts{1, 2, 3, 4, 5, 6};
constexpr double kWorthALength = 0.9999,
                 kWorthParts = 0.98;  // what a longer table and shorter frames must save

// What weighs how much when a turn is chosen: wire time; how level frames are, and in them the
// requests that are sent most often, which have the least room to move. Found by measuring; no set
// is the best on every bus, so each has a try.
struct Levels {
  double frames, steady;
};
constexpr std::array<Levels, 8> kLevels{
    {{4, 8}, {1, 3}, {2, 8}, {6, 6}, {8, 16}, {3, 3}, {12, 8}, {4, 20}}};

// The most of `usable` frames that goes into a table of `frames` without a rest, and of which
// `beat` does.
std::uint32_t lap_within(std::uint32_t usable, std::uint32_t beat, std::uint32_t frames) {
  if (usable >= frames) return usable / frames * frames;
  std::uint32_t lap = std::max(usable / beat, 1u) * beat;
  while (lap > beat && frames % lap != 0) lap -= beat;
  return lap;
}

std::size_t words_for(std::size_t members) { return (members + 63) / 64; }

double growth(std::int64_t before, double more) {
  return more * (2.0 * static_cast<double>(before) + more);
}

std::uint32_t frames_in(const TimetableMember& member, std::uint32_t parts) {
  return static_cast<std::uint32_t>(std::clamp(member.fits * parts + 0.001, 1.0, 1e9));
}

std::uint32_t beat_of(const TimetableRequest& request, std::uint32_t parts, std::uint32_t frames) {
  std::uint32_t own = ~0u;
  for (const TimetableMember& member : request.members)
    own = std::min(own, frames_in(member, parts));
  return own >= frames ? frames : lap_within(own, 1, frames);
}

}  // namespace

// Wire time for each beat, without the way to riders.
double Timetable::spent(std::uint32_t parts, std::uint32_t frames) const {
  double sum = 0;
  for (const TimetableRequest& request : requests_) {
    const std::uint32_t beat = beat_of(request, parts, frames);
    sum += static_cast<double>(request.base) / beat;
    for (const TimetableMember& member : request.members) {
      sum += member.item_ns * (member.end - member.first) /
             std::min(frames, lap_within(frames_in(member, parts), beat, frames));
    }
  }
  return sum * parts;
}

// The length and the frames that waste least: each member is read at its lap instead of the frames
// that it could wait.
void Timetable::choose_length() {
  constexpr std::size_t kMany = 2000;  // members for which a long table would take too long
  std::size_t members = 0;
  for (const TimetableRequest& request : requests_) members += request.members.size();
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t parts : kParts) {
    double best = std::numeric_limits<double>::infinity();
    std::uint32_t length = 1;
    for (const std::uint32_t frames : kLengths) {
      if (frames > 100 && members > kMany) break;
      const double now = spent(parts, frames);
      if (now < kWorthALength * best) best = now, length = frames;
    }
    if (best < kWorthParts * least) least = best, parts_ = parts, frames_ = length;
  }
  frame_ = std::max<std::int64_t>(1, beat_ / parts_);
  room_ = beat_room_ / parts_;
  shortest_ = frames_;
  for (const TimetableRequest& request : requests_) {
    if (!request.members.empty())
      shortest_ = std::min(shortest_, beat_of(request, parts_, frames_));
  }
}

void Timetable::set_laps(TimetableRequest& request) const {
  request.beat = beat_of(request, parts_, frames_);
  for (TimetableMember& member : request.members)
    member.lap = lap_within(frames_in(member, parts_), request.beat, frames_);
}

// Wire time of a request in a frame: of the members that are due in it, and one more.
std::int64_t Timetable::read(std::size_t index, std::uint32_t frame, std::size_t besides) const {
  const TimetableRequest& request = requests_[index];
  const std::size_t words = words_for(request.members.size());
  const std::uint64_t* const due = due_[index].data() + frame * words;
  const TimetableMember* range = nullptr;  // the first of it
  std::uint32_t end = 0;
  double sum = 0;
  for (std::size_t word = 0; word < words; ++word) {
    std::uint64_t left = due[word];
    if (besides / 64 == word) left |= std::uint64_t{1} << besides % 64;
    for (; left != 0; left &= left - 1) {
      const TimetableMember& member =
          request.members[word * 64 + static_cast<std::size_t>(std::countr_zero(left))];
      const bool joins =
          range != nullptr &&
          (!request.list || (member.area == range->area && member.first <= end + member.bridge));
      if (!joins) {
        sum += static_cast<double>(member.range_ns) - member.item_ns;
        range = &member;
        end = member.first;
      }
      if (member.end <= end) continue;
      sum += member.item_ns * (member.end - end);
      end = member.end;
    }
  }
  return range == nullptr ? 0 : request.base + static_cast<std::int64_t>(sum);
}

void Timetable::mark(std::size_t index, std::size_t member, std::uint32_t frame, bool due) {
  std::uint64_t& word =
      due_[index][frame * words_for(requests_[index].members.size()) + member / 64];
  const std::uint64_t bit = std::uint64_t{1} << member % 64;
  word = due ? word | bit : word & ~bit;
}

void Timetable::set_cost(std::size_t index, std::uint32_t frame, std::int64_t cost) {
  std::int64_t& now = this->cost(index, frame);
  total_[frame] += cost - now;
  if (requests_[index].beat == shortest_) steady_[frame] += cost - now;
  now = cost;
}

double Timetable::strain(std::size_t index, std::uint32_t frame, std::int64_t cost) const {
  const std::int64_t now = cost_[index * frames_ + frame];
  const auto more = static_cast<double>(cost - now);
  const double steady =
      requests_[index].beat == shortest_ ? level_steady_ * growth(steady_[frame], more) : 0;
  return more +
         (level_frames_ * growth(total_[frame], more) + steady) / static_cast<double>(frame_);
}

void Timetable::place(std::size_t index, std::size_t place) {
  const TimetableRequest& request = requests_[index];
  TimetableMember& member = requests_[index].members[place];
  double least = 0;
  std::uint32_t best = request.phase;
  for (std::uint32_t turn = request.phase; turn < std::min(member.lap, frames_);
       turn += request.beat) {
    double sum = 0;
    for (std::uint32_t frame = turn; frame < frames_ && (turn == request.phase || sum < least);
         frame += member.lap)
      sum += strain(index, frame, read(index, frame, place));
    if (turn == request.phase || sum < least) least = sum, best = turn;
  }
  member.turn = best;
  for (std::uint32_t frame = best; frame < frames_; frame += member.lap) {
    mark(index, place, frame, true);
    set_cost(index, frame, read(index, frame));
  }
}

void Timetable::take_out(std::size_t index, std::size_t place) {
  TimetableMember& member = requests_[index].members[place];
  for (std::uint32_t frame = std::exchange(member.turn, ~0u); frame < frames_;
       frame += member.lap) {
    mark(index, place, frame, false);
    set_cost(index, frame, read(index, frame));
  }
}

// The least crowded phase, then the members from the fastest to the slowest.
void Timetable::enter(std::size_t index) {
  TimetableRequest& request = requests_[index];
  std::int64_t least = 0;
  for (std::uint32_t phase = 0; phase < request.beat; ++phase) {
    std::int64_t sum = 0;
    for (std::uint32_t frame = phase; frame < frames_; frame += request.beat) sum += total_[frame];
    if (phase == 0 || sum < least) least = sum, request.phase = phase;
  }
  due_[index].assign(words_for(request.members.size()) * frames_, 0);
  std::vector<std::size_t> order;
  for (std::size_t place = 0; place < request.members.size(); ++place) {
    TimetableMember& member = request.members[place];
    member.turn = member.lap == request.beat ? request.phase : ~0u;
    if (member.turn == ~0u) {
      order.push_back(place);
      continue;
    }
    for (std::uint32_t frame = request.phase; frame < frames_; frame += request.beat)
      mark(index, place, frame, true);
  }
  for (std::uint32_t frame = request.phase; frame < frames_; frame += request.beat)
    set_cost(index, frame, read(index, frame));
  std::ranges::stable_sort(order, {},
                           [&](std::size_t place) { return request.members[place].lap; });
  for (const std::size_t place : order) this->place(index, place);
}

void Timetable::leave(std::size_t index) {
  for (std::uint32_t frame = 0; frame < frames_; ++frame) set_cost(index, frame, 0);
}

// When each request ends at the latest, if those that come before it in its frames do not end
// earlier than they must. Few beats come first; among them those whose reads change least.
void Timetable::align() {
  std::vector<std::size_t> order(requests_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto riders = [&](std::size_t index) {
    const TimetableRequest& request = requests_[index];
    return std::count_if(request.members.begin(), request.members.end(),
                         [&](const auto& m) { return m.lap > request.beat; });
  };
  std::vector<std::ptrdiff_t> slower(requests_.size());
  for (std::size_t index = 0; index < requests_.size(); ++index) slower[index] = riders(index);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::tuple(requests_[a].beat, slower[a]) < std::tuple(requests_[b].beat, slower[b]);
  });
  std::vector<std::int64_t> end(frames_, 0);
  for (const std::size_t index : order) {
    TimetableRequest& request = requests_[index];
    request.latest = 0;
    for (std::uint32_t frame = request.phase; frame < frames_; frame += request.beat) {
      end[frame] += cost(index, frame);
      request.latest = std::max(request.latest, end[frame]);
    }
    const std::int64_t earliest = request.latest - room_ * request.beat;
    for (std::uint32_t frame = request.phase; frame < frames_; frame += request.beat)
      end[frame] = std::max(end[frame], earliest);
  }
}

std::vector<Timetable> Timetable::fill(std::vector<TimetableRequest> requests, unsigned rounds) {
  constexpr std::size_t kLarge = 8'000;  // reads in the table: too many to make it more than once
  requests_ = std::move(requests);
  choose_length();
  for (TimetableRequest& request : requests_) set_laps(request);
  std::vector<Timetable> ways;
  for (const Levels& levels : kLevels) {
    level_frames_ = levels.frames;
    level_steady_ = levels.steady;
    settle(rounds);
    if (cost_.size() > kLarge) return {};
    ways.push_back(*this);
  }
  std::ranges::stable_sort(ways, {}, [](const Timetable& way) { return way.latest(); });
  *this = std::move(ways.front());
  ways.erase(ways.begin());
  return ways;
}

std::int64_t Timetable::latest() const {
  std::int64_t latest = 0;
  for (const TimetableRequest& request : requests_) latest = std::max(latest, request.latest);
  return latest;
}

bool Timetable::empty() const {
  return std::ranges::all_of(requests_,
                             [](const auto& request) { return request.members.empty(); });
}

void Timetable::settle(unsigned rounds) {
  cost_.assign(requests_.size() * frames_, 0);
  total_.assign(frames_, 0);
  steady_.assign(frames_, 0);
  due_.assign(requests_.size(), {});
  std::vector<std::size_t> order(requests_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return requests_[a].beat < requests_[b].beat;
  });
  for (const std::size_t index : order) enter(index);
  for (unsigned round = 0; round < rounds; ++round) {
    for (const std::size_t index : order) {
      if (requests_[index].beat > shortest_) {
        leave(index);
        enter(index);
        continue;
      }
      for (std::size_t member = 0; member < requests_[index].members.size(); ++member) {
        if (requests_[index].members[member].lap == requests_[index].beat) continue;
        take_out(index, member);
        place(index, member);
      }
    }
  }
  align();
}

void Timetable::change(std::size_t index, TimetableRequest request) {
  set_laps(request);
  TimetableRequest& before = requests_[index];
  const bool same =
      request.beat == before.beat &&
      std::equal(request.members.begin(), request.members.end(), before.members.begin(),
                 before.members.end(), [](const TimetableMember& a, const TimetableMember& b) {
                   return a.first == b.first && a.end == b.end && a.area == b.area &&
                          a.lap == b.lap;
                 });
  if (same) {
    request.phase = before.phase;
    for (std::size_t i = 0; i < request.members.size(); ++i)
      request.members[i].turn = before.members[i].turn;
    before = std::move(request);
    for (std::uint32_t frame = before.phase; frame < frames_; frame += before.beat)
      set_cost(index, frame, read(index, frame));
  } else {
    leave(index);
    before = std::move(request);
    if (!before.members.empty()) enter(index);
  }
}

double Timetable::load() const {
  const std::int64_t sum = std::accumulate(total_.begin(), total_.end(), std::int64_t{0});
  return static_cast<double>(sum) / (static_cast<double>(frame_) * frames_);
}

}  // namespace fieldcast
