#include "core/plan/layout/cost.hpp"

#include <algorithm>

#include "core/plan/layout/time_math.hpp"

namespace fieldcast {

Range ReadCost::aligned(std::uint32_t first, std::uint32_t end) const {
  const std::uint32_t from = first / alignment_ * alignment_;
  const std::uint32_t to = std::min(items_, (end + alignment_ - 1) / alignment_ * alignment_);
  return {area_, from, std::max(to, end) - from};
}

Duration wire_time(const ExchangeSize& size, const LineFormat& line, Duration silence,
                   const DeviceTiming& device) {
  return size.wire_time(line) + size.rounds * (device.response_time / device.in_flight + silence) +
         size.pauses + device.pause;
}

ReadCost::ReadCost(const DeviceTiming& device, AreaIndex area, const LineFormat& line,
                   Duration silence, std::uint32_t span)
    : area_(area), in_flight_(device.in_flight), max_gap_(device.max_gap) {
  const Area& rules = device.protocol->areas()[area];
  items_ = rules.items;
  item_bits_ = rules.item_bits;
  alignment_ = std::max<std::uint32_t>(1, rules.alignment);
  bank_ = rules.bank;
  window_ = rules.window;
  limit_ = rules.max_read;
  if (device.max_block != 0) limit_ = std::min<std::uint32_t>(limit_, device.max_block);
  if (window_) limit_ = span = items_;
  most_ = limit_;

  // Includes single points beyond the device's limit, and alignment at both ends.
  const std::uint32_t longest = std::min<std::uint32_t>({span + 2 * alignment_, items_, 65536});
  variable_.assign(longest + 1, kRefused);
  Request request = ReadRequest{{Range{area, 0, 1}}};
  Range& range = std::get<ReadRequest>(request).ranges.front();
  const std::uint32_t step = window_ ? longest : 1;
  for (std::uint32_t count = step; count != 0 && count <= longest; count += step) {
    range.count = count;
    const auto size = device.protocol->size(request);
    if (!size) continue;
    rounds_ = size->rounds;
    pauses_ = size->rounds * silence + device.pause;
    variable_[count] = size->wire_time(line) + size->pauses;
  }
  set_response_time(device.response_time);
}

void ReadCost::set_response_time(Duration response_time) {
  fixed_ = pauses_ + rounds_ * response_time / in_flight_;
  find_bridge();
}

void ReadCost::set_longest(std::uint32_t items) {
  limit_ = items == 0 || window_ ? most_ : std::min(most_, items);
}

void ReadCost::find_bridge() {
  std::uint32_t longest = static_cast<std::uint32_t>(variable_.size()) - 1;
  while (longest > 0 && variable_[longest] == kRefused) --longest;
  const std::uint32_t one = std::min(alignment_, longest);
  if (window_ || longest == 0 || variable_[one] == kRefused) {
    bridge_ = items_;
    return;
  }
  item_ns_ = longest > one ? ns(variable_[longest] - variable_[one]) / (longest - one) : 0.0;
  // Two requests cost fixed + variable twice; one that bridges g items reads those instead.
  const double request = ns(fixed_ + variable_[one]) - item_ns_ * one;
  bridge_ =
      item_ns_ > 0 ? static_cast<std::uint32_t>(std::min(request / item_ns_, 65535.0)) : items_;
  bridge_ += item_bits_ < 8 ? 8 / item_bits_ - 1 : 0;  // items of one byte are read together
  if (max_gap_) bridge_ = std::min<std::uint32_t>(bridge_, *max_gap_);
}

std::optional<Duration> ReadCost::of_single(const Range& range) const {
  if (at(range.count) == kRefused || !in_one_bank(range)) return std::nullopt;
  return of(range);
}

ListCost::ListCost(const DeviceTiming& device, const LineFormat& line, Duration silence)
    : protocol_(device.protocol),
      line_(line),
      silence_(silence),
      pause_(device.pause),
      response_time_(device.response_time),
      in_flight_(device.in_flight),
      max_items_(device.max_block) {
  const std::size_t count = protocol_->areas().size();
  for (std::size_t area = 0; area < count; ++area)
    areas_.push_back(measure(static_cast<AreaIndex>(area), device.max_gap));
}

std::optional<Duration> ListCost::ask(const Request& request) const {
  const auto size = protocol_->size(request);
  if (!size) return std::nullopt;
  return size->wire_time(line_) + size->rounds * silence_ + size->pauses + pause_;
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
  return *time + rounds_ * response_time_ / in_flight_;
}

}  // namespace fieldcast
