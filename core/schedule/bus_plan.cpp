#include "core/schedule/bus_plan.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <set>
#include <utility>

#include "core/schedule/bus_schedule.hpp"

namespace fieldcast {

namespace {

constexpr std::size_t kNamesInAdvice = 4;

std::string names_of(const BusPlan& plan, const std::vector<PointIndex>& points) {
  const std::set<PointIndex> wanted(points.begin(), points.end());
  std::string text;
  std::size_t count = 0, index = 0;
  for (const auto& device : plan.bus->devices) {
    for (const auto& channel : device.channels) {
      const auto point = plan.point_of[index++];
      if (!point || !wanted.contains(*point)) continue;
      if (count < kNamesInAdvice)
        text += (count == 0 ? "" : ", ") + device.name + '/' + channel.name;
      ++count;
    }
  }
  if (count == 1) return text;
  return std::to_string(count) + " channels (" + text + (count > kNamesInAdvice ? ", ..)" : ")");
}

// "1.25"
std::string hundredths(double number) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f", number);
  return text.data();
}

}  // namespace

BusPlan make_plan(const BusSpec& bus, Duration response_time) {
  BusPlan plan;
  plan.bus = &bus;
  plan.response_time = response_time;
  PointMap map = map_points(bus);
  std::vector<const Protocol*> protocols;
  for (const DeviceSpec& device : bus.devices) {
    plan.protocols.push_back(make_protocol(device, line_of(bus.port)).value());
    protocols.push_back(plan.protocols.back().get());
    for (const ChannelSpec& channel : device.channels) {
      plan.point_of.push_back(read_by_itself(channel) ? map.point_of[plan.point_of.size()]
                                                      : std::nullopt);
    }
  }
  // The schedule starts with the engine's assumption; the devices then respond after response_time.
  plan.input = schedule_input(bus, protocols, std::move(map.points), kAssumedResponseTime);
  for (DeviceTiming& device : plan.input.devices) device.response_time = response_time;
  // Another master may begin with the silence that this one has to learn.
  ScheduleInput least = plan.input;
  if (const auto* learned = std::get_if<LearnedSilence>(&bus.silence))
    least.silence = std::min(least.silence, least_silence(*learned, least.line));
  plan.bound = load_bound_of(least);
  plan.prediction = predict(plan.input, {.planner = bus.planner, .assumed = kAssumedResponseTime});
  return plan;
}

std::optional<double> share_of_possible(const BusPlan& plan) {
  if (!plan.prediction.feasible || !plan.bound || plan.bound->load <= 0) return std::nullopt;
  return std::min(1.0, plan.bound->load / plan.prediction.planned_load);
}

std::vector<std::string> advice(const BusPlan& plan) {
  std::vector<std::string> ways;
  if (plan.prediction.feasible) return ways;
  const auto& remedies = plan.prediction.remedies;
  std::string slower;
  for (const auto& group : remedies.slower) {
    slower += (slower.empty() ? "" : ", and ") + names_of(plan, group.points) + " every " +
              to_text(group.to) + " instead of " + to_text(group.from);
  }
  if (!slower.empty()) ways.push_back("refresh " + slower);
  if (remedies.stretch)
    ways.push_back("make every refresh " + hundredths(*remedies.stretch) + " times as long");
  if (remedies.baud && has_line(plan.bus->port))
    ways.push_back("run the line at " + std::to_string(*remedies.baud) + " baud");
  if (remedies.longer_reads)
    ways.emplace_back("take away max-block and max-gap, if the devices accept longer reads");
  if (remedies.no_pause)
    ways.emplace_back("take away the pause after each exchange, if the devices need none");
  if (remedies.buses)
    ways.push_back("spread the devices over " + std::to_string(*remedies.buses) +
                   " lines like this one");
  if (ways.empty())
    ways.emplace_back(
        "read fewer channels of each device: no longer refresh, faster line or split of the bus "
        "within reach is enough");
  return ways;
}

}  // namespace fieldcast
