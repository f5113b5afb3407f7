// Wire time of a read: request, response time, response, silence, pauses of the protocol and of the
// device. A table by item count makes it fast in the inner loops of planning. Values; any thread.
#pragma once

#include <cassert>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/time.hpp"
#include "core/frame/line.hpp"
#include "core/model/channel_kind.hpp"
#include "core/model/sample.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

struct DeviceTiming {
  const Protocol* protocol = nullptr;  // limits and exact sizes; must outlive its users
  Duration response_time{};            // expected: end of request to first byte of the response
  Duration pause{};                    // after each exchange with this device
  std::uint16_t max_block = 0;         // in items; 0: the protocol's limit
  // Unwanted items that a read may bridge; empty: as many as save time.
  std::optional<std::uint16_t> max_gap;
  unsigned in_flight = 1;  // requests that wait for their responses at the same time
};

// `silence` follows every response.
[[nodiscard]] Duration wire_time(const ExchangeSize& size, const LineFormat& line, Duration silence,
                                 const DeviceTiming& device);

class ReadCost {
 public:
  // `span`: longest read that will be evaluated, in items.
  ReadCost(const DeviceTiming& device, AreaIndex area, const LineFormat& line, Duration silence,
           std::uint32_t span);

  // Aligned, or the whole window.
  [[nodiscard]] Range cover(std::uint32_t first, std::uint32_t end) const {
    assert(first < end && end <= items_);
    if (window_) return {area_, 0, items_};
    return alignment_ == 1 ? Range{area_, first, end - first} : aligned(first, end);
  }

  // REQUIRES: range comes from cover().
  [[nodiscard]] bool fits(const Range& range) const {
    return window_ || (range.count <= limit_ && at(range.count) != kRefused && in_one_bank(range));
  }

  // REQUIRES: fits(range), or the range of a single point.
  [[nodiscard]] Duration of(const Range& range) const { return fixed_ + at(range.count); }

  // Ignores the device limit; empty if the protocol cannot read it.
  [[nodiscard]] std::optional<Duration> of_single(const Range& range) const;

  // More are forbidden or cost as much as another request.
  [[nodiscard]] std::uint32_t bridge() const { return bridge_; }

  // Average marginal cost of one more item, in nanoseconds.
  [[nodiscard]] double item_ns() const { return item_ns_; }

  [[nodiscard]] std::uint32_t limit() const { return limit_; }
  void set_response_time(Duration response_time);
  // In items; 0 restores the initial limit.
  void set_longest(std::uint32_t items);

 private:
  static constexpr Duration kRefused{-1};  // the protocol has no read of this size

  [[nodiscard]] Duration at(std::uint32_t count) const {
    return variable_[count < variable_.size() ? count : 0];
  }
  [[nodiscard]] Range aligned(std::uint32_t first, std::uint32_t end) const;
  [[nodiscard]] bool in_one_bank(const Range& range) const {
    return bank_ == 0 || range.first / bank_ == (range.end() - 1) / bank_;
  }
  void find_bridge();

  AreaIndex area_;
  std::uint32_t items_, item_bits_, alignment_, bank_;
  bool window_;
  std::uint32_t limit_ = 0;  // items in one read
  std::uint32_t most_ = 0;   // initial limit_
  Duration fixed_{};         // per read: response time, silence, pauses
  unsigned rounds_ = 1;      // requests and responses in one read
  unsigned in_flight_;
  Duration pauses_{};  // part of fixed_ without the response time
  // By item count: time of the characters. [0] is kRefused.
  std::vector<Duration> variable_;
  std::optional<std::uint16_t> max_gap_;
  std::uint32_t bridge_ = 0;
  double item_ns_ = 0;
};

// Exact wire time of a list of ranges, for protocols with Traits::max_ranges. The marginal costs of
// a range and of an item, used to select points, ignore padding. Values; any thread.
class ListCost {
 public:
  // REQUIRES: can_list(*device.protocol).
  ListCost(const DeviceTiming& device, const LineFormat& line, Duration silence);

  [[nodiscard]] static bool can_list(const Protocol& protocol) {
    return protocol.traits().max_ranges > 1;
  }

  // False for windows and aligned areas, which are read alone.
  [[nodiscard]] bool lists(AreaIndex area) const { return areas_[area].lists; }

  // Empty beyond the limits. `only_point`: ignores the device's limit. REQUIRES: a ReadRequest.
  [[nodiscard]] std::optional<Duration> of(const Request& request, bool only_point = false) const;

  // Marginal cost of a range of one item in a list, and of an item in a range.
  [[nodiscard]] Duration range_cost(AreaIndex area) const { return areas_[area].range_cost; }
  [[nodiscard]] double item_ns(AreaIndex area) const { return areas_[area].item_ns; }
  [[nodiscard]] std::uint32_t bridge(AreaIndex area) const { return areas_[area].bridge; }
  // Returns true if the items cost less as part of `range`, which begins before them.
  [[nodiscard]] bool joins(const Range& range, AreaIndex area, std::uint32_t first,
                           std::uint32_t end) const;
  [[nodiscard]] Duration request_cost() const {
    return request_cost_ + rounds_ * response_time_ / in_flight_;
  }

  void set_response_time(Duration response_time) { response_time_ = response_time; }

 private:
  struct PerArea {
    bool lists = false;
    Duration range_cost{};
    double item_ns = 0;
    std::uint32_t bridge = 0;
  };
  [[nodiscard]] std::optional<Duration> ask(const Request& request) const;
  [[nodiscard]] PerArea measure(AreaIndex area, const std::optional<std::uint16_t>& max_gap);

  const Protocol* protocol_;
  LineFormat line_;
  Duration silence_, pause_;
  Duration response_time_;
  unsigned rounds_ = 1;  // requests and responses in one read
  unsigned in_flight_;
  Duration request_cost_{};  // without the response time
  std::uint32_t max_items_;  // 0: the protocol's limit
  std::vector<PerArea> areas_;
};

// Input of planning: points, the line, and the devices. Plain values.
using PointIndex = std::uint32_t;  // in the order of ScheduleInput::points

// A range that is read for one or more channels, with their shortest refresh.
struct Point {
  DeviceIndex device = 0;
  Range range;
  Duration refresh = std::chrono::seconds{1};
  Mode mode = Mode::kScheduled;  // kOnDemand: never scheduled
  int priority = 0;
  double elasticity = 1;  // its share of a stretch within its priority
};

struct ScheduleInput {
  LineFormat line;
  Duration silence{};  // after each response
  // How early a scheduled point is read before it is due; at most a tenth of its refresh.
  Duration lead = std::chrono::milliseconds{2};
  std::vector<DeviceTiming> devices;
  std::vector<Point> points;
};

}  // namespace fieldcast
