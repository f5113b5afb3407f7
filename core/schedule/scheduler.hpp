// What to read next on one bus, and when. Pure: no clock, no I/O; every call gets `now`.
//
// The scheduler knows points (distinct item ranges that some channel needs) with their refreshes,
// groups them into blocks by the wire's cost, and answers one question whenever the wire is free:
// read this block now, or rest until then.
//
// Owned by the bus engine and touched by it alone.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "core/base/time.hpp"
#include "core/model/sample.hpp"
#include "core/model/spec.hpp"
#include "core/plan/cost.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

using PointIndex = std::uint32_t;  // in the order of the Points given

// One distinct range that is read for one or more channels. Its refresh is the shortest of theirs.
struct Point {
  DeviceIndex device = 0;
  Range range;
  Duration refresh = std::chrono::seconds{1};
  Mode mode = Mode::kScheduled;  // kOnDemand: never scheduled
  int priority = 0;
  double elasticity = 1;  // its share of a stretch beside the other points of its priority
};

struct ScheduleInput {
  LineFormat line;
  Duration silence{};  // after each answer
  Duration lead = std::chrono::milliseconds{
      2};  // how early a scheduled point is read before it is due, at most a tenth of its refresh
  std::vector<DeviceTiming> devices;
  std::vector<Point> points;
};

// One read: the ranges for one request (one, for protocols without range lists) and the points
// whose data it brings.
struct Block {
  DeviceIndex device = 0;
  std::vector<Range> ranges;
  std::vector<PointIndex> points;
  Duration cost{};  // of the wire: request, answer, answer time, silence, pause
};
struct Rest {
  Instant until = kNever;
};  // nothing is worth reading before then
using Decision = std::variant<Block, Rest>;

// A plan in the making, from a copy of all that the scheduler knew: it can be made on any thread.
class PlanDraft {
 public:
  virtual ~PlanDraft() = default;
  virtual void make() = 0;
};

class Scheduler {
 public:
  virtual ~Scheduler() = default;
  // REQUIRES: the wire is free at `now`. Points whose device is paused until later are left out.
  [[nodiscard]] virtual Decision next(Instant now) = 0;
  // The points of the block were acquired at `acquired` (the answer's last byte).
  virtual void acquired(const Block& block, Instant acquired) = 0;
  // The block failed for a reason that is not its addresses; its points stay due, tried again not
  // before `retry_at`.
  virtual void failed(const Block& block, Instant now, Instant retry_at) = 0;
  // The device refused the block's addresses. More than one point: halves are read next, and a gap
  // between two good halves is remembered as not to be bridged. A single point: it is left alone
  // until now + forget. Returns the points that are now known to be bad (empty while the search
  // goes on).
  virtual std::vector<PointIndex> refused(const Block& block, Instant now, Duration forget) = 0;
  // No reads of this device before `until` (offline, pausing); kNever stops it.
  virtual void suspend(DeviceIndex device, Instant until) = 0;
  // Learned of the device: what reads of an area take until the answer begins, and the longest of
  // them that it accepts (items; 0: no other than the configured).
  virtual void set_answer_time(DeviceIndex device, AreaIndex area, Duration answer_time) = 0;
  virtual void set_longest(DeviceIndex device, AreaIndex area, std::uint32_t items) = 0;
  // How long the wire may be blocked from `now` on by something else (a probe of a silent device)
  // without making a point late that would otherwise be in time. Zero when there is none to spare.
  [[nodiscard]] virtual Duration slack(Instant now) = 0;
  // Another refresh or mode for a point, effective at once (interest, overload).
  virtual void set_point(PointIndex point, Duration refresh, Mode mode, Instant now) = 0;
  // What was learned and wished since the plan in force was made may be worth another one. That
  // takes milliseconds, for ten thousand points a tenth of a second: not on the wire's time. Null:
  // nothing has changed, or a draft is out.
  [[nodiscard]] virtual std::unique_ptr<PlanDraft> draft() = 0;
  // Puts a plan in force. REQUIRES: the last draft of this scheduler, made.
  virtual void adopt(PlanDraft& draft, Instant now) = 0;
  // Share of the wire that the plan needs in the long run, 0..; above 1 is overload.
  [[nodiscard]] virtual double planned_load() const = 0;
  // Factor by which overload stretches all refreshes at present; 1 without overload.
  [[nodiscard]] virtual double stretch() const = 0;
};

// Makes a new plan here and now, if one is due: where the caller's time is not the wire's.
void replan(Scheduler& scheduler, Instant now);

// REQUIRES: points name devices of the input and areas of their protocols. A refresh shorter than
// the wire time of its own point counts as that time. A point that no request of its protocol can
// carry is never read. Time begins with the first call of next().
[[nodiscard]] std::unique_ptr<Scheduler> make_scheduler(const ScheduleInput& input,
                                                        Planner planner = Planner::kRiding);

// The load of a plan and how far it stretches refreshes, without the plan.
struct PlannedLoad {
  double load = 0, stretch = 1;
};
[[nodiscard]] PlannedLoad planned_load_of(const ScheduleInput& input, Planner planner);

}  // namespace fieldcast
