// Wire time of a read of several ranges, for protocols with lists of ranges (Traits::max_ranges).
// Exact for a whole list. The marginal costs of a range and of an item, used to select points,
// ignore padding. Values; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/plan/layout/cost.hpp"

namespace fieldcast {

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
  unsigned rounds_ = 1;      // requests and responses in one read
  Duration request_cost_{};  // without the response time
  std::uint32_t max_items_;  // 0: the protocol's limit
  std::vector<PerArea> areas_;
};

}  // namespace fieldcast
