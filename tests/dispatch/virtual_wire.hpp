// Simulates an ideal half-duplex line in virtual time with a scheduler as its master.
#pragma once

#include <algorithm>
#include <functional>
#include <vector>

#include "core/dispatch/scheduler.hpp"

namespace fieldcast::test {

// How the devices respond to a block; they respond normally if empty.
enum class Answer { kGood, kRefused, kSilent };

class VirtualWire {
 public:
  VirtualWire(const ScheduleInput& input, Scheduler& scheduler)
      : input_(input), scheduler_(scheduler), seen_(input.points.size()) {
    for (auto& seen : seen_) seen.last = kStart;
  }

  // Runs for `length` of virtual time. Calls the check, if set, with every block before it is read.
  void run(Duration length) {
    const Instant end = now_ + length;
    while (now_ < end) {
      Decision decision = scheduler_.next(now_);
      if (const auto* rest = std::get_if<Rest>(&decision)) {
        now_ = std::min(end, std::max(rest->until, now_ + std::chrono::microseconds{1}));
        continue;
      }
      read(std::get<Block>(decision));
    }
  }

  struct Seen {
    Instant last{};
    std::uint64_t count = 0, missed = 0;
    Duration longest{}, shortest = Duration::max();  // gaps since the first acquisition
  };
  [[nodiscard]] const Seen& seen(PointIndex point) const { return seen_[point]; }
  [[nodiscard]] std::uint64_t missed() const {
    std::uint64_t sum = 0;
    for (const auto& seen : seen_) sum += seen.missed;
    return sum;
  }
  [[nodiscard]] std::size_t overdue() const {
    std::size_t count = 0;
    for (PointIndex point = 0; point < seen_.size(); ++point) {
      if (input_.points[point].mode != Mode::kOnDemand &&
          now_ - seen_[point].last > input_.points[point].refresh)
        ++count;
    }
    return count;
  }
  void forget_gaps() {
    for (auto& seen : seen_) seen = Seen{seen.last};
    busy_ = Duration{};
    blocks_ = 0;
    since_ = now_;
  }
  [[nodiscard]] double load() const { return to_seconds(busy_) / to_seconds(now_ - since_); }
  [[nodiscard]] std::uint64_t blocks() const { return blocks_; }
  [[nodiscard]] Instant now() const { return now_; }

  std::function<Answer(const Block&)> device;
  std::function<void(const Block&)> check;
  double pace = 1;  // duration of a read, relative to the time at the line's rate
  Duration timeout = std::chrono::milliseconds{200};
  Duration retry_after{};
  Duration forget = std::chrono::minutes{10};
  std::vector<PointIndex> bad;

 private:
  static constexpr Instant kStart{std::chrono::seconds{1000}};

  void read(const Block& block) {
    if (check) check(block);
    const Answer answer = device ? device(block) : Answer::kGood;
    const Duration tail = input_.silence + input_.devices[block.device].pause;
    ++blocks_;
    if (answer == Answer::kSilent) {
      now_ += block.cost + timeout;
      busy_ += block.cost + timeout;
      scheduler_.failed(block, now_, now_ + retry_after);
      return;
    }
    const Duration took = from_seconds(to_seconds(block.cost - tail) * pace) + tail;
    const Instant acquired = now_ + took - tail;
    now_ += took;
    busy_ += took;
    if (answer == Answer::kRefused) {
      for (const PointIndex point : scheduler_.refused(block, acquired, forget))
        bad.push_back(point);
      return;
    }
    for (const PointIndex point : block.points) note(point, acquired);
    scheduler_.acquired(block, acquired);
    replan(scheduler_, now_);
  }
  void note(PointIndex point, Instant acquired) {
    Seen& seen = seen_[point];
    const Duration gap = acquired - seen.last;
    if (gap > input_.points[point].refresh) ++seen.missed;
    if (seen.count > 0) {
      seen.longest = std::max(seen.longest, gap);
      seen.shortest = std::min(seen.shortest, gap);
    }
    seen.last = acquired;
    ++seen.count;
  }

  const ScheduleInput& input_;
  Scheduler& scheduler_;
  std::vector<Seen> seen_;
  Instant now_ = kStart, since_ = kStart;
  Duration busy_{};
  std::uint64_t blocks_ = 0;
};

}  // namespace fieldcast::test
