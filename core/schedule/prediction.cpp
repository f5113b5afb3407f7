#include "core/schedule/prediction.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <tuple>
#include <utility>

#include "core/schedule/overload.hpp"

namespace fieldcast {

namespace {

constexpr Instant kStart{std::chrono::seconds{1}};
constexpr std::size_t kMostBlocks = 1000;    // shown
constexpr std::size_t kMostShapes = 20'000;  // counted

Duration horizon_of(const ScheduleInput& input, const PredictionOptions& options) {
  if (options.horizon > Duration{0}) return options.horizon;
  Duration longest{};
  for (const Point& point : input.points) {
    if (point.mode != Mode::kOnDemand) longest = std::max(longest, std::min<Duration>(point.refresh, std::chrono::hours{1}));
  }
  return std::clamp<Duration>(3 * longest, std::chrono::seconds{60}, std::chrono::hours{1});
}

// One run of the scheduler over an ideal wire.
class Run {
 public:
  Run(const ScheduleInput& input, const PredictionOptions& options)
      : input_(input), options_(options), scheduler_(make_scheduler(input, options.planner)), last_(input.points.size(), kStart) {
    result_.points.resize(input.points.size());
    for (std::size_t i = 0; i < input.points.size(); ++i) result_.points[i].refresh = input.points[i].refresh;
    result_.planned_load = scheduler_->planned_load();
    result_.stretch = scheduler_->stretch();
  }

  // `stop_at_miss`: only feasibility is wanted.
  Prediction run(bool stop_at_miss) {
    const Instant end = kStart + horizon_of(input_, options_);
    while (now_ < end && result_.reads < options_.max_reads && !(stop_at_miss && result_.missed > 0)) {
      const Decision decision = scheduler_->next(now_);
      if (const auto* rest = std::get_if<Rest>(&decision)) {
        now_ = std::min(end, std::max(rest->until, now_ + Duration{1}));
      } else {
        read(std::get<Block>(decision));
      }
    }
    finish();
    return std::move(result_);
  }

 private:
  void read(const Block& block) {
    const Instant acquired = now_ + block.cost - input_.silence - input_.devices[block.device].pause;
    now_ += block.cost;
    busy_ += block.cost;
    ++result_.reads;
    for (const PointIndex point : block.points) {
      gap(point, acquired);
      ++result_.points[point].reads;
      last_[point] = acquired;
    }
    scheduler_->acquired(block, acquired);
    replan(*scheduler_, now_);
    if (shapes_.size() < kMostShapes) {
      Shape& shape = shapes_[key_of(block)];
      if (shape.count++ == 0) shape.block = block;
    }
  }
  void gap(PointIndex point, Instant until) {
    PointForecast& forecast = result_.points[point];
    const Duration gap = until - last_[point];
    forecast.worst_gap = std::max(forecast.worst_gap, gap);
    if (gap > forecast.refresh) ++forecast.missed, ++result_.missed;
  }
  void finish() {
    result_.horizon = now_ - kStart;
    for (PointIndex point = 0; point < input_.points.size(); ++point) {
      if (input_.points[point].mode != Mode::kOnDemand) gap(point, now_);
    }
    const double seconds = std::max(1e-9, to_seconds(result_.horizon));
    result_.load = to_seconds(busy_) / seconds;
    result_.feasible = result_.missed == 0;
    std::vector<Shape*> shapes;
    for (auto& [key, shape] : shapes_) shapes.push_back(&shape);
    std::stable_sort(shapes.begin(), shapes.end(), [](const Shape* a, const Shape* b) { return a->count > b->count; });
    if (shapes.size() > kMostBlocks) shapes.resize(kMostBlocks);
    for (Shape* shape : shapes) {
      Block& block = shape->block;
      result_.blocks.push_back(
          {block.device, std::move(block.ranges), block.points.size(), block.cost, static_cast<double>(shape->count) / seconds});
    }
    std::sort(result_.blocks.begin(), result_.blocks.end(), [](const BlockForecast& a, const BlockForecast& b) {
      const Range &p = a.ranges.front(), &q = b.ranges.front();
      return std::tuple(a.device, p.area, p.first, p.count) < std::tuple(b.device, q.area, q.first, q.count);
    });
  }

  struct Shape {
    std::uint64_t count = 0;
    Block block;
  };
  using ShapeKey = std::vector<std::uint64_t>;
  static ShapeKey key_of(const Block& block) {
    ShapeKey key{block.device};
    for (const Range& range : block.ranges)
      key.insert(key.end(), {std::uint64_t{range.area} << 32 | range.first, std::uint64_t{range.count}});
    return key;
  }
  const ScheduleInput& input_;
  const PredictionOptions& options_;
  std::unique_ptr<Scheduler> scheduler_;
  std::vector<Instant> last_;
  Instant now_ = kStart;
  Duration busy_{};
  Prediction result_;
  std::map<ShapeKey, Shape> shapes_;
};

// Whether a nearly full wire that missed nothing owes that to the length of the run.
bool is_narrow(const ScheduleInput& input, const PredictionOptions& options, const Prediction& prediction) {
  constexpr double kNearlyFull = 0.8, kShorter = 0.95;
  return prediction.planned_load > kNearlyFull && Run(stretched(input, kShorter), options).run(true).missed > 0;
}

bool works(const ScheduleInput& input, const PredictionOptions& options) {
  const Prediction prediction = Run(input, options).run(true);
  return prediction.feasible && !is_narrow(input, options, prediction);
}

// The least factor on all refreshes that works, to two per cent.
std::optional<double> stretch_that_works(const ScheduleInput& input, const PredictionOptions& options, double load) {
  double works_at = std::max(1.05, load), fails_at = 1;
  for (int doubling = 0; !works(stretched(input, works_at), options); ++doubling) {
    if (doubling == 8) return std::nullopt;
    fails_at = works_at;
    works_at *= doubling < 3 ? 1.25 : 2;
  }
  while (works_at > fails_at * 1.02) {
    const double middle = (works_at + fails_at) / 2;
    (works(stretched(input, middle), options) ? works_at : fails_at) = middle;
  }
  return works_at;
}

std::optional<std::uint32_t> baud_that_works(const ScheduleInput& input, const PredictionOptions& options) {
  for (const std::uint32_t baud : kStandardRates) {
    const auto faster = at_rate(input, baud);
    if (faster && works(*faster, options)) return baud;
  }
  return std::nullopt;
}

// What is left of a bus with only these devices.
ScheduleInput part_of(const ScheduleInput& input, const std::vector<DeviceIndex>& devices) {
  ScheduleInput part = input;
  std::erase_if(part.points, [&](const Point& point) { return std::ranges::find(devices, point.device) == devices.end(); });
  return part;
}

// Devices spread over the fewest lines: the heaviest first, each to the line that has the least so far.
std::optional<std::size_t> buses_that_work(const ScheduleInput& input, const PredictionOptions& options) {
  constexpr std::size_t kMostBuses = 8;
  std::vector<std::pair<double, DeviceIndex>> heaviest;
  for (DeviceIndex device = 0; device < input.devices.size(); ++device) {
    const ScheduleInput alone = part_of(input, {device});
    if (!alone.points.empty()) heaviest.emplace_back(wished_load(alone, options.planner), device);
  }
  std::ranges::sort(heaviest, std::greater<>{});
  for (std::size_t count = 2; count <= std::min(kMostBuses, heaviest.size()); ++count) {
    std::vector<std::pair<double, std::vector<DeviceIndex>>> lines(count);
    for (const auto& [load, device] : heaviest) {
      auto& least = *std::ranges::min_element(lines, {}, [](const auto& line) { return line.first; });
      least.first += load;
      least.second.push_back(device);
    }
    if (std::ranges::all_of(lines, [&](const auto& line) { return line.first < 1 && works(part_of(input, line.second), options); }))
      return count;
  }
  return std::nullopt;
}

// Whether it works when a change, which says whether it is one, is made to every device.
template <typename Change>
bool works_with(const ScheduleInput& input, const PredictionOptions& options, Change change) {
  ScheduleInput other = input;
  bool changed = false;
  for (DeviceTiming& device : other.devices) changed = change(device) || changed;
  return changed && works(other, options);
}

// The next longer of 1, 2, 5, 10, ... in the decade of the refresh.
Duration next_refresh(Duration refresh) {
  Duration decade{1};
  while (decade * 10 <= refresh) decade *= 10;
  for (const int step : {2, 5}) {
    if (decade * step > refresh) return decade * step;
  }
  return decade * 10;
}

// Slows down the points of the shortest refresh, again and again, until it works.
std::vector<SlowerPoints> slower_that_works(const ScheduleInput& input, const PredictionOptions& options) {
  constexpr int kMostSteps = 20;
  ScheduleInput slower = input;
  bool found = false;
  for (int step = 0; step < kMostSteps && !found; ++step) {
    Duration shortest = Duration::max();
    for (const Point& point : slower.points) {
      if (point.mode != Mode::kOnDemand) shortest = std::min(shortest, point.refresh);
    }
    if (shortest > std::chrono::hours{1}) return {};
    for (Point& point : slower.points) {
      if (point.refresh == shortest) point.refresh = next_refresh(shortest);
    }
    found = works(slower, options);
  }
  if (!found) return {};
  std::map<Duration, SlowerPoints> groups;
  for (PointIndex point = 0; point < input.points.size(); ++point) {
    const Duration from = input.points[point].refresh, to = slower.points[point].refresh;
    if (from == to || input.points[point].mode == Mode::kOnDemand) continue;
    SlowerPoints& group = groups[from];
    group.from = from;
    group.to = to;
    group.points.push_back(point);
  }
  std::vector<SlowerPoints> result;
  for (auto& [from, group] : groups) result.push_back(std::move(group));
  return result;
}

}  // namespace

ScheduleInput stretched(const ScheduleInput& input, double factor) {
  ScheduleInput result = input;
  for (Point& point : result.points) point.refresh = from_seconds(to_seconds(point.refresh) * factor);
  return result;
}

std::optional<ScheduleInput> at_rate(const ScheduleInput& input, std::uint32_t baud) {
  if (baud <= input.line.baud) return std::nullopt;
  ScheduleInput faster = input;
  faster.line.baud = baud;
  // Silences shrink with the characters, but not below 1.75 ms (Modbus over Serial Line V1.02, 2.5.1.1) unless they were shorter.
  const Duration shrunk{input.silence.count() * input.line.baud / baud};
  faster.silence = std::max(shrunk, std::min<Duration>(input.silence, std::chrono::microseconds{1750}));
  return faster;
}

Prediction predict(const ScheduleInput& input, const PredictionOptions& options) {
  Prediction prediction = Run(input, options).run(false);
  prediction.narrow = prediction.feasible && is_narrow(input, options, prediction);
  prediction.feasible = prediction.feasible && !prediction.narrow;
  if (prediction.planned_load > 1) prediction.planned_load = wished_load(input, options.planner);
  if (prediction.feasible || !options.remedies) return prediction;
  prediction.remedies.stretch = stretch_that_works(input, options, prediction.planned_load);
  prediction.remedies.baud = baud_that_works(input, options);
  prediction.remedies.slower = slower_that_works(input, options);
  prediction.remedies.longer_reads = works_with(input, options, [](DeviceTiming& device) {
    const bool limited = device.max_block != 0 || device.max_gap;
    device.max_block = 0;
    device.max_gap.reset();
    return limited;
  });
  prediction.remedies.no_pause =
      works_with(input, options, [](DeviceTiming& device) { return std::exchange(device.pause, Duration{}) > Duration{}; });
  prediction.remedies.buses = buses_that_work(input, options);
  return prediction;
}

}  // namespace fieldcast
