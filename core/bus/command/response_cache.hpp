// The last responses of each device to reads, as the device sent them, for clients of the gateway.
// A response is stored and returned whole, so that values of several items are never mixed. Owned
// by CommandQueue, on the bus's thread.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"
#include "core/model/sample.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

struct DeviceResponse {
  Range range;
  Bytes items;         // the image of `range`
  Instant asked{};     // when its request was sent
  Instant acquired{};  // when its last byte arrived

  [[nodiscard]] bool contains(const Range& other) const {
    return range.area == other.area && range.first <= other.first && range.end() >= other.end();
  }
  // REQUIRES: contains(part). `item_bits`: of the area.
  [[nodiscard]] Bytes items_of(const Range& part, unsigned item_bits) const {
    const ByteView view = ByteView(items).subspan(image_bytes(item_bits, part.first - range.first),
                                                  image_bytes(item_bits, part.count));
    return {view.begin(), view.end()};
  }
};

class ResponseCache {
 public:
  // A further response replaces the oldest one of its device.
  static constexpr std::size_t kMaxOfDevice = 64;

  explicit ResponseCache(std::size_t devices) : of_device_(devices) {}

  void put(DeviceIndex device, DeviceResponse response) {
    auto& stored = of_device_[device];
    std::erase_if(stored, [&](const auto& each) { return response.contains(each.range); });
    if (stored.size() == kMaxOfDevice) stored.erase(stored.begin());
    stored.push_back(std::move(response));
  }
  // A write may change any item of the device.
  void forget(DeviceIndex device) { of_device_[device].clear(); }

  // The newest response that contains the range; null if it is older than `since`, or missing.
  [[nodiscard]] const DeviceResponse* find(DeviceIndex device, const Range& range,
                                           Instant since) const {
    const auto& stored = of_device_[device];
    const auto found = std::find_if(stored.rbegin(), stored.rend(),
                                    [&](const auto& each) { return each.contains(range); });
    return found == stored.rend() || found->acquired < since ? nullptr : &*found;
  }

 private:
  std::vector<std::vector<DeviceResponse>> of_device_;  // oldest first
};

}  // namespace fieldcast
