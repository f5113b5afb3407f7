// What a read of several ranges costs of the wire, for protocols that carry lists of ranges in one
// request (Traits::max_ranges).
//
// Exact for a whole list, asked from the protocol. To choose who comes along there are marginal
// costs, which are exact but for padding: what one more range adds, and what one more item of a
// range adds. Values; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/plan/cost.hpp"

namespace fieldcast {

class ListCost {
 public:
  // REQUIRES: can_list(*device.protocol).
  ListCost(const DeviceTiming& device, const LineFormat& line, Duration silence);

  [[nodiscard]] static bool can_list(const Protocol& protocol) {
    return protocol.traits().max_ranges > 1;
  }

  // Whether ranges of this area may stand in a list: windows and aligned areas are read alone.
  [[nodiscard]] bool lists(AreaIndex area) const { return areas_[area].lists; }

  // Nothing beyond the limits of the protocol or of the device. `only_point`: the device's limit
  // does not count. REQUIRES: a ReadRequest.
  [[nodiscard]] std::optional<Duration> of(const Request& request, bool only_point = false) const;

  // What a range of one item adds to a list, and what another item adds to a range.
  [[nodiscard]] Duration range_cost(AreaIndex area) const { return areas_[area].range_cost; }
  [[nodiscard]] double item_ns(AreaIndex area) const { return areas_[area].item_ns; }
  // Unwanted items that cost less than another range.
  [[nodiscard]] std::uint32_t bridge(AreaIndex area) const { return areas_[area].bridge; }
  // Whether items first .. end-1 are better read with `range`, which begins before them, than by a
  // range of their own.
  [[nodiscard]] bool joins(const Range& range, AreaIndex area, std::uint32_t first,
                           std::uint32_t end) const;
  // What a request costs before it asks for anything.
  [[nodiscard]] Duration request_cost() const { return request_cost_ + rounds_ * answer_time_; }

  void set_answer_time(Duration answer_time) { answer_time_ = answer_time; }

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
  Duration answer_time_;
  unsigned rounds_ = 1;      // requests and answers in one read
  Duration request_cost_{};  // without the answer time
  std::uint32_t max_items_;  // 0: the protocol's limit
  std::vector<PerArea> areas_;
};

}  // namespace fieldcast
