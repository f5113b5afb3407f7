#include "core/schedule/prediction.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "core/schedule/overload.hpp"
#include "core/schedule/planned_times.hpp"

namespace fieldcast {

namespace {

constexpr Instant kStart{std::chrono::seconds{1}};
constexpr std::size_t kMostBlocks = 1000;    // shown
constexpr std::size_t kMostShapes = 20'000;  // counted

Duration horizon_of(const ScheduleInput& input, const PredictionOptions& options) {
  if (options.horizon > Duration{0}) return options.horizon;
  Duration longest{};
  for (const Point& point : input.points) {
    if (point.mode != Mode::kOnDemand)
      longest = std::max(longest, std::min<Duration>(point.refresh, std::chrono::hours{1}));
  }
  return std::clamp<Duration>(3 * longest, std::chrono::seconds{60}, std::chrono::hours{1});
}

ScheduleInput assumed_of(const ScheduleInput& input, const PredictionOptions& options) {
  ScheduleInput assumed = input;
  for (DeviceTiming& device : assumed.devices)
    device.response_time = options.assumed.value_or(device.response_time);
  return assumed;
}

std::vector<std::size_t> areas_of(const ScheduleInput& input) {
  std::vector<std::size_t> areas;
  for (const DeviceTiming& device : input.devices) areas.push_back(device.protocol->areas().size());
  return areas;
}

class Run {
 public:
  Run(const ScheduleInput& input, const PredictionOptions& options)
      : input_(input),
        options_(options),
        scheduler_(std::make_unique<Scheduler>(assumed_of(input, options), options.planner,
                                               CyclicWeights{.search = options.search})),
        last_(input.points.size(), kStart) {
    if (options.assumed) times_ = PlannedTimes(areas_of(input), *options.assumed);
    result_.points.resize(input.points.size());
    for (std::size_t i = 0; i < input.points.size(); ++i)
      result_.points[i].refresh = input.points[i].refresh;
  }

  Prediction run(bool stop_at_miss) {
    const Instant end = kStart + horizon_of(input_, options_);
    while (now_ < end && result_.reads < options_.max_reads &&
           !(stop_at_miss && result_.missed > 0)) {
      Decision decision = scheduler_->next(now_);
      if (const auto* rest = std::get_if<Rest>(&decision)) {
        now_ = std::min(end, std::max(rest->until, now_ + Duration{1}));
      } else {
        read(std::get<Block>(std::move(decision)));
      }
    }
    finish();
    return std::move(result_);
  }

 private:
  [[nodiscard]] Duration cost_of(const Block& block) const {
    if (!options_.assumed) return block.cost;
    const DeviceTiming& device = input_.devices[block.device];
    const auto size = device.protocol->size(ReadRequest{block.ranges});
    return size ? wire_time(*size, input_.line, input_.silence, device) : block.cost;
  }
  void read(Block block) {
    block.cost = cost_of(block);
    const DeviceTiming& device = input_.devices[block.device];
    const Instant acquired = now_ + block.cost - input_.silence - device.pause;
    now_ += block.cost;
    busy_ += block.cost;
    ++result_.reads;
    for (const PointIndex point : block.points) {
      gap(point, acquired);
      ++result_.points[point].reads;
      last_[point] = acquired;
    }
    if (options_.assumed)
      times_.responded(block.device, block.ranges.front().area, device.response_time, *scheduler_);
    scheduler_->acquired(block, acquired);
    replan(*scheduler_, acquired);
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
    result_.plan = scheduler_->plan();
    result_.planned_load = scheduler_->planned_load();
    result_.stretch = scheduler_->stretch();
    for (PointIndex point = 0; point < input_.points.size(); ++point) {
      if (input_.points[point].mode != Mode::kOnDemand) gap(point, now_);
    }
    const double seconds = std::max(1e-9, to_seconds(result_.horizon));
    result_.load = to_seconds(busy_) / seconds;
    result_.feasible = result_.missed == 0;
    std::vector<Shape*> shapes;
    for (auto& [key, shape] : shapes_) shapes.push_back(&shape);
    std::stable_sort(shapes.begin(), shapes.end(),
                     [](const Shape* a, const Shape* b) { return a->count > b->count; });
    if (shapes.size() > kMostBlocks) shapes.resize(kMostBlocks);
    for (Shape* shape : shapes) {
      Block& block = shape->block;
      result_.blocks.push_back({block.device, std::move(block.ranges), block.points.size(),
                                block.cost, static_cast<double>(shape->count) / seconds});
    }
    std::sort(result_.blocks.begin(), result_.blocks.end(),
              [](const BlockForecast& a, const BlockForecast& b) {
                const Range &p = a.ranges.front(), &q = b.ranges.front();
                return std::tuple(a.device, p.area, p.first, p.count) <
                       std::tuple(b.device, q.area, q.first, q.count);
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
      key.insert(key.end(),
                 {std::uint64_t{range.area} << 32 | range.first, std::uint64_t{range.count}});
    return key;
  }
  const ScheduleInput& input_;
  const PredictionOptions& options_;
  std::unique_ptr<Scheduler> scheduler_;
  PlannedTimes times_;
  std::vector<Instant> last_;
  Instant now_ = kStart;
  Duration busy_{};
  Prediction result_;
  std::map<ShapeKey, Shape> shapes_;
};

// Returns true if a nearly full wire missed no refresh only because the run was short.
bool is_narrow(const ScheduleInput& input, const PredictionOptions& options,
               const Prediction& prediction) {
  constexpr double kNearlyFull = 0.8, kShorter = 0.95;
  return prediction.planned_load > kNearlyFull &&
         Run(stretched(input, kShorter), options).run(true).missed > 0;
}

bool works(const ScheduleInput& input, const PredictionOptions& options) {
  const Prediction prediction = Run(input, options).run(true);
  return prediction.feasible && !is_narrow(input, options, prediction);
}

}  // namespace

Prediction predict(const ScheduleInput& input, const PredictionOptions& options) {
  Prediction prediction = Run(input, options).run(false);
  prediction.narrow = prediction.feasible && is_narrow(input, options, prediction);
  prediction.feasible = prediction.feasible && !prediction.narrow;
  if (prediction.planned_load > 1) prediction.planned_load = asked_load(input, options.planner);
  if (prediction.feasible || !options.remedies) return prediction;
  PredictionOptions quick = options;  // dozens of plans are tried
  quick.search = false;
  const auto works_too = [&](const ScheduleInput& other) { return works(other, quick); };
  prediction.remedies = find_remedies(input, works_too, prediction.planned_load, options.planner);
  return prediction;
}

}  // namespace fieldcast
