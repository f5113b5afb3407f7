// What a read costs of the wire: request, the device's answer time, answer, silence, the protocol's
// own pauses and the device's rest.
//
// Exact: one entry for each item count, asked from the protocol once and kept as a table, so that
// the inner loops of planning are an addition and a look-up. Values; any thread.
#pragma once

#include <cassert>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/time.hpp"
#include "core/frame/line.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

// What planning must know of a device.
struct DeviceTiming {
  const Protocol* protocol = nullptr;  // limits and exact sizes; outlives whoever plans with it
  Duration answer_time{};              // expected: end of request to first byte of the answer
  Duration pause{};                    // rest after each exchange with this device
  std::uint16_t max_block = 0;         // items; 0: the protocol's limit
  // Unwanted items that a read may bridge; nothing: whatever pays.
  std::optional<std::uint16_t> max_gap;
};

// Wire time of one request with its answer. `silence` follows every answer.
[[nodiscard]] Duration wire_time(const ExchangeSize& size, const LineFormat& line, Duration silence,
                                 const DeviceTiming& device);

// The cost of reads of one range in one area of one device.
class ReadCost {
 public:
  // `span`: the longest read that will ever be asked for, in items.
  ReadCost(const DeviceTiming& device, AreaIndex area, const LineFormat& line, Duration silence,
           std::uint32_t span);

  // The range that must be asked for to get items first .. end-1: aligned, or the whole window.
  [[nodiscard]] Range cover(std::uint32_t first, std::uint32_t end) const {
    assert(first < end && end <= items_);
    if (window_) return {area_, 0, items_};
    return alignment_ == 1 ? Range{area_, first, end - first} : aligned(first, end);
  }

  // Within the limits of the protocol and the device. REQUIRES: range comes from cover().
  [[nodiscard]] bool fits(const Range& range) const {
    return window_ || (range.count <= limit_ && at(range.count) != kRefused && in_one_bank(range));
  }

  // REQUIRES: fits(range), or the range of a single point.
  [[nodiscard]] Duration of(const Range& range) const { return fixed_ + at(range.count); }

  // The same for a single point that no device limit shall keep from being asked for; nothing if
  // the protocol cannot carry it.
  [[nodiscard]] std::optional<Duration> of_single(const Range& range) const;

  // Unwanted items that a read may bridge: more cost as much as another request, or are forbidden.
  [[nodiscard]] std::uint32_t bridge() const { return bridge_; }

  // Marginal cost of one more item, on average: nanoseconds and parts of one.
  [[nodiscard]] double item_ns() const { return item_ns_; }

  [[nodiscard]] std::uint32_t limit() const { return limit_; }
  void set_answer_time(Duration answer_time);
  // The device accepts no longer reads (items); 0: as it was made.
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
  std::uint32_t most_ = 0;   // as it was made
  Duration fixed_{};         // of every read: answer time, silence, pauses
  unsigned rounds_ = 1;      // requests and answers in one read
  Duration pauses_{};        // what `fixed_` holds besides the answer time
  // By item count: the characters. [0] is kRefused.
  std::vector<Duration> variable_;
  std::optional<std::uint16_t> max_gap_;
  std::uint32_t bridge_ = 0;
  double item_ns_ = 0;
};

}  // namespace fieldcast
