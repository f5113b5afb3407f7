#include "tools/cli/view/simulation_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace fieldcast::cli {

namespace {

std::vector<std::vector<std::string>> channels_by_point(const BusPlan& plan) {
  std::vector<std::vector<std::string>> names(plan.input.points.size());
  std::size_t index = 0;
  for (const DeviceSpec& device : plan.bus->devices) {
    for (const ChannelSpec& channel : device.channels) {
      if (const auto point = plan.point_of[index++]) names[*point].push_back(channel.name);
    }
  }
  return names;
}

Json in_cycle(Duration period, Duration time) {
  return period == Duration::zero() ? Json() : Json(time.count());
}

Json to_json(const PlanReport::Point& point) {
  return {{"area", point.area},
          {"first", point.first},
          {"count", point.count},
          {"channels", point.channels},
          {"period", in_cycle(point.period, point.period)},
          {"phase", in_cycle(point.period, point.phase)},
          {"worst_gap", point.worst_gap ? Json(point.worst_gap->count()) : Json()},
          {"stretch", point.stretch}};
}

Json to_json(const PlanReport::Group& group) {
  auto points = Json::array();
  for (const PlanReport::Point& point : group.points) points.push_back(to_json(point));
  return {{"device", group.device},
          {"list", group.list},
          {"period", in_cycle(group.period, group.period)},
          {"phase", in_cycle(group.period, group.phase)},
          {"slack", in_cycle(group.period, group.slack)},
          {"load", group.load},
          {"points", points}};
}

}  // namespace

Json read_plan_json(const PlanReport& plan) {
  auto groups = Json::array();
  for (const PlanReport::Group& group : plan.groups) groups.push_back(to_json(group));
  return {{"load", plan.load},
          {"stretch", plan.stretch},
          {"slot", in_cycle(plan.slot, plan.slot)},
          {"hyperperiod", in_cycle(plan.slot, plan.hyperperiod)},
          {"groups", groups}};
}

Json read_plan_json(const BusPlan& bus) {
  const auto channels = channels_by_point(bus);
  return read_plan_json(
      report_of(bus.prediction.plan, bus.input.points,
                {.device = [&](DeviceIndex device) -> std::string_view {
                   return bus.bus->devices[device].name;
                 },
                 .area = [&](DeviceIndex device, AreaIndex area) -> std::string_view {
                   return bus.protocols[device]->areas()[area].name;
                 },
                 .channels = [&](PointIndex point) { return channels[point]; }}));
}

namespace {

std::string percent(double share) { return fmt::format("{:.1f} %", share * 100); }
std::string tenth_ms(Duration time) { return fmt::format("{:.1f} ms", to_seconds(time) * 1e3); }

struct Row {
  const DeviceSpec* device = nullptr;
  const ChannelSpec* channel = nullptr;
  const ChannelReport* report = nullptr;
  const PointForecast* forecast = nullptr;
  [[nodiscard]] double tightness() const {
    return to_seconds(report->worst_gap) / to_seconds(channel->refresh);
  }
};

std::vector<Row> rows_of(const BusSimulation& simulation) {
  std::vector<Row> rows;
  std::size_t index = 0;
  for (const DeviceSpec& device : simulation.plan->bus->devices) {
    for (const ChannelSpec& channel : device.channels) {
      const auto point = simulation.plan->point_of[index];
      if (point)
        rows.push_back({&device, &channel, &simulation.channels[index],
                        &simulation.plan->prediction.points[*point]});
      ++index;
    }
  }
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
    return std::pair(a.report->missed, a.tightness()) > std::pair(b.report->missed, b.tightness());
  });
  return rows;
}

std::uint64_t refreshes_of(const std::vector<Row>& rows) {
  std::uint64_t sum = 0;
  for (const Row& row : rows) sum += row.report->readings;
  return sum;
}

template <typename Visit>
void for_each_cause(const CauseCounters& counters, Visit visit) {
  for (std::size_t i = 1; i < static_cast<std::size_t>(Cause::kCount); ++i) {
    const auto cause = static_cast<Cause>(i);
    if (counters[cause] != 0) visit(cause, counters[cause]);
  }
}

std::string causes_text(const CauseCounters& counters) {
  std::string text;
  for_each_cause(counters, [&](Cause cause, std::uint64_t count) {
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", to_text(cause), count);
  });
  return text;
}

Json causes_json(const CauseCounters& counters) {
  Json json = Json::object();
  for_each_cause(counters,
                 [&](Cause cause, std::uint64_t count) { json.add(to_name(cause), count); });
  return json;
}

TextTable channel_table(const std::string& bus, const std::vector<Row>& rows) {
  TextTable table({{"channel"},
                   {"refresh", Align::kRight},
                   {"worst gap", Align::kRight},
                   {"predicted", Align::kRight},
                   {"refreshes", Align::kRight},
                   {"missed", Align::kRight},
                   {"last cause"}});
  for (const Row& row : rows) {
    const bool missed = row.report->missed != 0;
    table.add_row(
        {{bus + '/' + row.device->name + '/' + row.channel->name},
         {to_text(row.channel->refresh)},
         {tenth_ms(row.report->worst_gap), row.tightness() > 1 ? Tone::kBad : Tone::kPlain},
         {tenth_ms(row.forecast->worst_gap), Tone::kFaint},
         {std::to_string(row.report->readings)},
         {std::to_string(row.report->missed), missed ? Tone::kBad : Tone::kGood},
         {missed ? std::string(to_text(row.report->last_miss)) : ""}});
  }
  return table;
}

}  // namespace

std::vector<std::string> simulation_lines(const BusSimulation& simulation, const Screen& screen) {
  const auto rows = rows_of(simulation);
  const BusReport& bus = simulation.bus;
  const bool kept = bus.deadline_misses == 0;
  std::vector<std::string> lines{
      painted(printable(fmt::format(
                  "{}: {} simulated, seed {}: {} refreshes, {} missed{}",
                  simulation.plan->bus->name, to_text(simulation.options.length),
                  simulation.options.seed, refreshes_of(rows), bus.deadline_misses,
                  kept ? std::string{} : fmt::format(" ({})", causes_text(bus.misses)))),
              kept ? Tone::kGood : Tone::kBad, screen.colour),
      fmt::format(
          "wire load: predicted {}, measured {}; {} exchanges{}",
          percent(simulation.plan->prediction.load), percent(bus.measured_load), bus.exchanges,
          bus.stretch > 1.001
              ? fmt::format("; overload: refreshes are stretched by up to {:.2f}", bus.stretch)
              : "")};
  if (bus.causes.total() != 0) lines.push_back("failed exchanges: " + causes_text(bus.causes));
  lines.emplace_back();
  for (auto& line : channel_table(simulation.plan->bus->name, rows).render(screen))
    lines.push_back(std::move(line));
  return lines;
}

Json simulation_json(const BusSimulation& simulation) {
  const auto rows = rows_of(simulation);
  const BusReport& bus = simulation.bus;
  Json channels = Json::array(), devices = Json::array();
  for (const Row& row : rows) {
    channels.push_back(
        {{"device", row.device->name},
         {"channel", row.channel->name},
         {"refresh", row.channel->refresh.count()},
         {"refreshes", row.report->readings},
         {"missed", row.report->missed},
         {"last_cause", row.report->missed != 0 ? to_name(row.report->last_miss) : ""},
         {"worst_gap", row.report->worst_gap.count()},
         {"predicted_gap", row.forecast->worst_gap.count()}});
  }
  for (std::size_t i = 0; i < simulation.devices.size(); ++i) {
    const DeviceReport& device = simulation.devices[i];
    devices.push_back({{"device", simulation.plan->bus->devices[i].name},
                       {"state", to_text(device.state)},
                       {"exchanges", device.exchanges},
                       {"failures", device.failures},
                       {"retries", device.retries},
                       {"answer_time", device.response_time.count()},
                       {"answer_spread", device.response_spread.count()}});
  }
  return {{"bus", simulation.plan->bus->name},
          {"simulated", simulation.options.length.count()},
          {"seed", simulation.options.seed},
          {"refreshes", refreshes_of(rows)},
          {"missed", bus.deadline_misses},
          {"causes", causes_json(bus.misses)},
          {"failures", causes_json(bus.causes)},
          {"exchanges", bus.exchanges},
          {"stretch", bus.stretch},
          {"planned_load", bus.planned_load},
          {"predicted_load", simulation.plan->prediction.load},
          {"measured_load", bus.measured_load},
          {"channels", channels},
          {"devices", devices},
          {"fingerprint", std::to_string(simulation.fingerprint)}};
}

}  // namespace fieldcast::cli
