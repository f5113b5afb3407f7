#include "core/plan/layout/list_cost.hpp"

#include <algorithm>

#include "core/plan/layout/time_math.hpp"

namespace fieldcast {

ListCost::ListCost(const DeviceTiming& device, const LineFormat& line, Duration silence)
    : protocol_(device.protocol),
      line_(line),
      silence_(silence),
      pause_(device.pause),
      answer_time_(device.answer_time),
      max_items_(device.max_block) {
  const std::size_t count = protocol_->areas().size();
  for (std::size_t area = 0; area < count; ++area)
    areas_.push_back(measure(static_cast<AreaIndex>(area), device.max_gap));
}

std::optional<Duration> ListCost::ask(const Request& request) const {
  const auto size = protocol_->size(request);
  if (!size) return std::nullopt;
  return line_.characters(size->request_characters + size->answer_characters) +
         size->rounds * silence_ + size->pauses + pause_;
}

// A single range may use another command with a shorter request (FINS).
ListCost::PerArea ListCost::measure(AreaIndex index, const std::optional<std::uint16_t>& max_gap) {
  PerArea result;
  const Area& area = protocol_->areas()[index];
  if (area.window || area.alignment > 1) return result;
  Request request = ReadRequest{{{index, 0, 1}, {index, 0, 1}}};
  auto& ranges = std::get<ReadRequest>(request).ranges;
  const auto two = ask(request);
  const std::uint32_t longer = std::min<std::uint32_t>(
      {1 + 16 * std::max(1u, 8 / area.item_bits), area.items, area.max_read});
  ranges[1].count = longer;
  const auto long_one = ask(request);
  ranges[1].count = 1;
  ranges.push_back({index, 0, 1});
  const auto three = ask(request);
  if (!two || !three || !long_one) return result;
  result.lists = true;
  result.range_cost = *three - *two;
  result.item_ns = longer > 1 ? ns(*long_one - *two) / (longer - 1) : ns(result.range_cost);
  if (result.item_ns > 0)
    result.bridge = static_cast<std::uint32_t>(
        std::clamp(ns(result.range_cost) / result.item_ns - 1.0, 0.0, 65535.0));
  if (max_gap) result.bridge = std::min<std::uint32_t>(result.bridge, *max_gap);
  request_cost_ = *two - 2 * result.range_cost;
  if (const auto size = protocol_->size(request)) rounds_ = size->rounds;
  return result;
}

bool ListCost::joins(const Range& range, AreaIndex area, std::uint32_t first,
                     std::uint32_t end) const {
  if (range.area != area || first > range.end() + areas_[area].bridge) return false;
  const Area& rules = protocol_->areas()[area];
  const std::uint32_t to = std::max(range.end(), end);
  return to - range.first <= rules.max_read && in_one_bank(rules, range.first, to);
}

std::optional<Duration> ListCost::of(const Request& request, bool only_point) const {
  const auto& ranges = std::get<ReadRequest>(request).ranges;
  if (ranges.empty() || ranges.size() > protocol_->traits().max_ranges) return std::nullopt;
  if (max_items_ != 0 && !only_point) {
    std::uint64_t items = 0;
    for (const Range& range : ranges) items += range.count;
    if (items > max_items_) return std::nullopt;
  }
  const auto time = ask(request);
  if (!time) return std::nullopt;
  return *time + rounds_ * answer_time_;
}

}  // namespace fieldcast
