// Reads of a bus in virtual time, as texts: decisions/NAME.txt has a configuration, and what
// happens at which time, each with the reads from then on. The wire is ideal: a read ends after its
// wire time, unless the text says that its device is silent, refuses or is slow.
#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <set>

#include "core/dispatch/scheduler.hpp"
#include "tests/plan/loaded_bus.hpp"
#include "tests/support/golden.hpp"

namespace fieldcast::test {
namespace {

constexpr Instant kStart{std::chrono::seconds{100}};
constexpr Duration kTimeout = std::chrono::milliseconds{50};
constexpr Duration kForget = std::chrono::seconds{20};

class DispatchedBus {
 public:
  explicit DispatchedBus(const std::string& head) : loaded_(head) {}

  // planner fastest-member | planner one-per-channel: those for comparison
  // run 300ms      shows each read: when it begins, in ms since the start, its device and points
  // count 10s      shows only how often each point was read, and its longest gap
  // silent plc | responds plc | refuses plc/a | accepts plc/a
  // slow plc 1.2   reads last longer than planned
  // learned plc 9ms | longest plc 4 | refresh plc/a 100ms MODE | suspend plc 500ms | free 30ms
  std::string respond(const std::string& line) {
    const auto words = words_of(line);
    const std::string& event = words[0];
    if (event == "responses") {
      loaded_.set_response_time(duration_of(words[2]));
      return {};
    }
    if (event == "planner") {
      loaded_.bus.planner =
          words[1] == "fastest-member" ? Planner::kFastestMember : Planner::kOnePerChannel;
      return {};
    }
    if (event == "in-flight") {
      in_flight_ = true;
      return {};
    }
    if (event == "inherit") {
      scheduler().inherit(loaded_.point(words[1]), kStart - duration_of(words[2]));
      return {};
    }
    if (event == "run" || event == "count") return run(duration_of(words[1]), event == "run");
    if (event == "plan") return planned();
    if (event == "free") return free_time(duration_of(words[1]));
    if (event == "silent")
      silent_.insert(loaded_.device(words[1]));
    else if (event == "responds")
      silent_.erase(loaded_.device(words[1]));
    else if (event == "refuses")
      refused_.insert(loaded_.point(words[1]));
    else if (event == "accepts")
      refused_.erase(loaded_.point(words[1]));
    else if (event == "slow")
      pace_[loaded_.device(words[1])] = std::stod(words[2]);
    else if (event == "suspend")
      scheduler().suspend(loaded_.device(words[1]), now_ + duration_of(words[2]));
    else if (event == "learned")
      scheduler().set_response_time(loaded_.device(words[1]), area_of(words[1]),
                                    duration_of(words[2]));
    else if (event == "longest")
      scheduler().set_longest(loaded_.device(words[1]), area_of(words[1]),
                              static_cast<std::uint32_t>(std::stoul(words[2])));
    else if (event == "refresh")
      set_refresh(loaded_.point(words[1]), duration_of(words[2]), words[3]);
    else
      return " !! unknown: " + line + '\n';
    replan(scheduler(), now_);
    return {};
  }

 private:
  void set_refresh(PointIndex point, Duration refresh, const std::string& mode) {
    Point wanted;
    wanted.refresh = refresh;
    wanted.mode = mode == "scheduled"   ? Mode::kScheduled
                  : mode == "intensive" ? Mode::kIntensive
                                        : Mode::kOnDemand;
    scheduler().set_point(point, wanted, now_);
  }
  Scheduler& scheduler() {
    if (!scheduler_) {
      scheduler_ = std::make_unique<Scheduler>(loaded_.input, loaded_.bus.planner);
      seen_.resize(loaded_.input.points.size());
    }
    return *scheduler_;
  }
  // Of the first channel of the device.
  [[nodiscard]] AreaIndex area_of(const std::string& device) const {
    return loaded_.bus.devices[loaded_.device(device)].channels.front().range.area;
  }
  [[nodiscard]] std::string at(Instant time) const { return ms_text(time - kStart); }

  std::string planned() {
    const ReadPlan& plan = scheduler().plan();
    std::string text = "  load " + percent_text(scheduler().planned_load()) + ", stretch " +
                       factor_text(scheduler().stretch()) + ", demand " +
                       percent_text(plan.demand) + ", slots " + ms_text(plan.slot()) + " of " +
                       ms_text(plan.hyperperiod()) + ':';
    for (const PlannedGroup& group : plan.groups)
      text += ' ' + ms_text(group.period) + '@' + ms_text(group.phase);
    return text + '\n';
  }
  std::string free_time(Duration use) {
    const Duration slack = scheduler().slack(now_);
    return "  at " + at(now_) + " the wire is free for " +
           (slack == Duration::max() ? "ever" : ms_text(slack)) + "; for " + ms_text(use) +
           (scheduler().has_headroom(now_, use) ? " it has headroom\n" : " it has none\n");
  }
  std::string run(Duration length, bool show) {
    std::string text;
    const Instant end = now_ + length;
    for (Seen& seen : seen_) seen.count = 0, seen.longest = {};
    std::size_t reads = 0;
    Duration busy{};
    while (now_ < end) {
      const Decision decision = scheduler().next(now_);
      if (const auto* rest = std::get_if<Rest>(&decision)) {
        if (show && rest->until == kNever) text += "  " + at(now_) + " rests for ever\n";
        now_ = std::min(end, std::max(rest->until, now_ + Duration{1}));
        continue;
      }
      const Instant began = now_;
      const std::string what = read(std::get<Block>(decision));
      busy += now_ - began;
      ++reads;
      if (show) text += "  " + at(began) + ' ' + what + '\n';
    }
    if (show) return text;
    text = "  " + std::to_string(reads) + " reads, " + ms_text(busy) + " ms\n";
    for (PointIndex point = 0; point < seen_.size(); ++point) {
      text += "  " + loaded_.name(point) + ": " + std::to_string(seen_[point].count) +
              " reads, longest gap " + ms_text(seen_[point].longest) + '\n';
    }
    return text;
  }
  // Returns "plc a b 12.599", and what the device did if it did not respond well.
  std::string read(const Block& block) {
    std::string text = loaded_.bus.devices[block.device].name;
    for (const PointIndex point : block.points) {
      const std::string name = loaded_.name(point);
      text += name.substr(name.find('/')).replace(0, 1, " ");
    }
    text += ", " + ms_text(block.cost);
    if (silent_.contains(block.device)) {
      now_ += block.cost + kTimeout;
      scheduler().failed(block, now_, now_ + kTimeout);
      return text + ", silent";
    }
    const auto pace = pace_.find(block.device);
    const Duration tail = loaded_.input.silence + loaded_.input.devices[block.device].pause;
    const Duration took = part_of(pace == pace_.end() ? 1.0 : pace->second, block.cost - tail);
    const Instant responded = now_ + took;
    if (in_flight_) scheduler().launched(block, now_);
    now_ = responded + tail;
    if (touches_refused(block)) {
      text += ", refused";
      for (const PointIndex bad : scheduler().refused(block, responded, kForget))
        text += ", bad: " + loaded_.name(bad);
      return text;
    }
    for (const PointIndex point : block.points) {
      Seen& seen = seen_[point];
      if (seen.last) seen.longest = std::max(seen.longest, responded - *seen.last);
      seen.last = responded;
      ++seen.count;
    }
    if (in_flight_)
      scheduler().confirmed(block, responded);
    else
      scheduler().acquired(block, responded);
    replan(scheduler(), responded);
    return text;
  }
  [[nodiscard]] bool touches_refused(const Block& block) const {
    for (const PointIndex point : refused_) {
      const Range& bad = loaded_.input.points[point].range;
      if (loaded_.input.points[point].device != block.device) continue;
      for (const Range& range : block.ranges) {
        if (range.area == bad.area && range.first < bad.end() && bad.first < range.end())
          return true;
      }
    }
    return false;
  }

  struct Seen {
    std::size_t count = 0;
    std::optional<Instant> last;
    Duration longest{};
  };
  LoadedBus loaded_;
  std::unique_ptr<Scheduler> scheduler_;
  Instant now_ = kStart;
  std::vector<Seen> seen_;
  std::set<DeviceIndex> silent_;
  std::set<PointIndex> refused_;
  std::map<DeviceIndex, double> pace_;
  bool in_flight_ = false;
};

class WrittenDecisions : public testing::TestWithParam<std::string> {};

TEST_P(WrittenDecisions, IsAsWritten) {
  expect_bus_responses<DispatchedBus>(FIELDCAST_DECISIONS "/" + GetParam() + ".txt");
}

INSTANTIATE_TEST_SUITE_P(Files, WrittenDecisions,
                         testing::ValuesIn(golden_names(FIELDCAST_DECISIONS)), golden_test_name);

}  // namespace
}  // namespace fieldcast::test
