#include "tools/cli/view/plan_view.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/cli/view/simulation_view.hpp"

namespace fieldcast::cli {
namespace {

std::string milliseconds(Duration time) {
  const double number = to_seconds(time) * 1e3;
  return time < std::chrono::milliseconds{100} ? fmt::format("{:.2f} ms", number)
                                               : fmt::format("{:.0f} ms", number);
}

Duration rounded(Duration time) {
  if (time < std::chrono::seconds{10}) return std::chrono::round<std::chrono::milliseconds>(time);
  return std::chrono::round<std::chrono::seconds>(time);
}

struct Row {
  const DeviceSpec* device = nullptr;
  const ChannelSpec* channel = nullptr;
  const PointForecast* forecast = nullptr;
  // Worst gap divided by refresh; above 1 the refresh is not kept.
  [[nodiscard]] double tightness() const {
    return to_seconds(forecast->worst_gap) / to_seconds(channel->refresh);
  }
};

std::vector<Row> rows_of(const BusPlan& plan) {
  std::vector<Row> rows;
  std::size_t index = 0;
  for (const auto& device : plan.bus->devices) {
    for (const auto& channel : device.channels) {
      if (const auto point = plan.point_of[index++])
        rows.push_back({&device, &channel, &plan.prediction.points[*point]});
    }
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Row& a, const Row& b) { return a.tightness() > b.tightness(); });
  return rows;
}

std::vector<BlockForecast> blocks_of(const BusPlan& plan) {
  auto blocks = plan.prediction.blocks;
  std::stable_sort(blocks.begin(), blocks.end(),
                   [](const auto& a, const auto& b) { return a.per_second > b.per_second; });
  return blocks;
}

// The addresses of its first and its last channel, as the configuration writes them.
std::string range_text(const DeviceSpec& device, const Range& range) {
  const ChannelSpec *first = nullptr, *last = nullptr;
  for (const ChannelSpec& channel : device.channels) {
    const Range& own = channel.range;
    if (channel.calculation || own.area != range.area || own.first < range.first ||
        own.end() > range.end())
      continue;
    if (!first || own.first < first->range.first) first = &channel;
    if (!last || own.end() > last->range.end()) last = &channel;
  }
  if (!first) return {};
  return first->at == last->at ? first->at : first->at + " .. " + last->at;
}

// "wire load 98.5 %", and beyond that "3.20 times the wire is needed".
std::string load_text(double load) {
  if (load <= 1) return fmt::format("wire load {:.1f} %", load * 100);
  return fmt::format("{:.{}f} times the wire is needed", load, load < 10 ? 2 : 0);
}

std::string verdict(const BusPlan& plan) {
  const auto& prediction = plan.prediction;
  return fmt::format(
      "{}  {}: {}, {}, {} reads in {} of virtual time, {} late (devices assumed to respond after "
      "{})",
      plan.bus->name, to_text(plan.bus->port),
      prediction.feasible ? "feasible"
      : prediction.narrow ? "TOO NARROW"
                          : "NOT FEASIBLE",
      load_text(prediction.planned_load), prediction.reads, to_text(rounded(prediction.horizon)),
      prediction.missed, to_text(plan.response_time));
}

// "any master needs at least 80.3 % of the wire; this plan is 92 % of what any master can reach";
// empty if the least load is not known.
std::string bound_text(const BusPlan& plan) {
  if (!plan.bound || plan.bound->load <= 0) return {};
  const double least = plan.bound->load;
  if (least > 1)
    return fmt::format("proven impossible: any master needs at least {:.2f} times the wire", least);
  const std::string needs =
      fmt::format("any master needs at least {:.1f} % of the wire", least * 100);
  if (!plan.prediction.feasible) return "no plan found, none is proven impossible: " + needs;
  return fmt::format("{}; this plan is {:.0f} % of what any master can reach", needs,
                     share_of_possible(plan).value_or(0) * 100);
}

// "uint32, low word first": the type, and its order if it has one.
std::string type_text(const Encoding& encoding) {
  std::string text = to_text(encoding);
  if (encoding.type != ValueType::kString && width_bits(encoding) > 16)
    text +=
        encoding.word_order == WordOrder::kLittleEndian ? ", low word first" : ", high word first";
  if (encoding.byte_order == ByteOrder::kLittleEndian && width_bits(encoding) > 8)
    text += ", low byte first";
  return text;
}

const char* order_text(bool little) { return little ? "little-endian" : "big-endian"; }

TextTable channel_table(const BusPlan& plan) {
  TextTable table({{"channel"},
                   {"at"},
                   {"type"},
                   {"refresh", Align::kRight},
                   {"worst gap", Align::kRight},
                   {"of refresh", Align::kRight},
                   {"reads", Align::kRight}});
  for (const auto& row : rows_of(plan)) {
    const double tightness = row.tightness();
    table.add_row(
        {{plan.bus->name + '/' + row.device->name + '/' + row.channel->name},
         {row.channel->at, Tone::kFaint},
         {type_text(row.channel->encoding), Tone::kFaint},
         {to_text(row.channel->refresh)},
         {milliseconds(row.forecast->worst_gap), tightness > 1 ? Tone::kBad : Tone::kPlain},
         {fmt::format("{:.0f} %", tightness * 100), tightness > 1 ? Tone::kBad : Tone::kGood},
         {std::to_string(row.forecast->reads)}});
  }
  return table;
}

TextTable block_table(const BusPlan& plan) {
  TextTable table({{"block"},
                   {"device"},
                   {"points", Align::kRight},
                   {"wire", Align::kRight},
                   {"each second", Align::kRight}});
  for (const auto& block : blocks_of(plan)) {
    const DeviceSpec& device = plan.bus->devices[block.device];
    std::string ranges;
    for (const auto& range : block.ranges)
      ranges += (ranges.empty() ? "" : ", ") + range_text(device, range);
    table.add_row({{ranges},
                   {device.name},
                   {std::to_string(block.points)},
                   {milliseconds(block.cost)},
                   {fmt::format("{:.2f}", block.per_second)}});
  }
  return table;
}

}  // namespace

std::vector<std::string> plan_lines(const BusPlan& plan, const Screen& screen) {
  std::vector<std::string> lines{painted(printable(verdict(plan)),
                                         plan.prediction.feasible ? Tone::kGood : Tone::kBad,
                                         screen.colour)};
  if (std::string bound = bound_text(plan); !bound.empty()) lines.push_back(std::move(bound));
  std::ptrdiff_t unsolicited = 0, calculated = 0;
  for (const DeviceSpec& device : plan.bus->devices) {
    unsolicited += std::ranges::count_if(device.channels, &ChannelSpec::unsolicited);
    calculated += std::ranges::count_if(device.channels, [](const ChannelSpec& channel) {
      return static_cast<bool>(channel.calculation);
    });
  }
  const auto unread = std::count(plan.point_of.begin(), plan.point_of.end(), std::nullopt) -
                      unsolicited - calculated;
  if (calculated != 0)
    lines.push_back(
        fmt::format("{} channels are calculated by the bridge; they need no wire", calculated));
  if (unsolicited != 0)
    lines.push_back(fmt::format(
        "{} channels are sent by their devices by themselves; they are not planned", unsolicited));
  if (unread != 0)
    lines.push_back(
        fmt::format("{} channels are read only when somebody asks, and cost nothing here", unread));
  lines.emplace_back();
  for (auto& line : channel_table(plan).render(screen)) lines.push_back(std::move(line));
  lines.emplace_back();
  for (auto& line : block_table(plan).render(screen)) lines.push_back(std::move(line));
  const auto ways = advice(plan);
  if (ways.empty()) return lines;
  lines.emplace_back();
  lines.emplace_back("any of these would make it feasible:");
  for (const auto& way : ways) lines.push_back("  - " + printable(way));
  return lines;
}

Json plan_json(const BusPlan& plan) {
  const auto& prediction = plan.prediction;
  const auto share = share_of_possible(plan);
  Json channels = Json::array(), blocks = Json::array();
  constexpr auto kLowWord = WordOrder::kLittleEndian;
  constexpr auto kLowByte = ByteOrder::kLittleEndian;
  for (const auto& row : rows_of(plan)) {
    const Encoding& encoding = row.channel->encoding;
    channels.push_back({{"device", row.device->name},
                        {"channel", row.channel->name},
                        {"type", to_text(encoding)},
                        {"word_order", order_text(encoding.word_order == kLowWord)},
                        {"byte_order", order_text(encoding.byte_order == kLowByte)},
                        {"refresh", row.channel->refresh.count()},
                        {"worst_gap", row.forecast->worst_gap.count()},
                        {"reads", row.forecast->reads}});
  }
  for (const auto& block : blocks_of(plan)) {
    auto ranges = Json::array();
    for (const auto& range : block.ranges) {
      ranges.push_back({{"area", plan.protocols[block.device]->areas()[range.area].name},
                        {"first", range.first},
                        {"count", range.count}});
    }
    blocks.push_back({{"device", plan.bus->devices[block.device].name},
                      {"ranges", ranges},
                      {"points", block.points},
                      {"cost", block.cost.count()},
                      {"per_second", block.per_second}});
  }
  return {{"bus", plan.bus->name},
          {"feasible", prediction.feasible},
          {"load", prediction.load},
          {"planned_load", prediction.planned_load},
          {"least_load", plan.bound ? Json(plan.bound->load) : Json()},
          {"share_of_possible", share ? Json(*share) : Json()},
          {"stretch", prediction.stretch},
          {"horizon", prediction.horizon.count()},
          {"reads", prediction.reads},
          {"missed", prediction.missed},
          {"answer_time", plan.response_time.count()},
          {"channels", channels},
          {"blocks", blocks},
          {"plan", read_plan_json(plan)},
          {"advice", advice(plan)}};
}

}  // namespace fieldcast::cli
