// Finds requests of another master in unsolicited bytes by the protocols of the bus. Immutable, any
// thread.
#pragma once

#include <functional>
#include <vector>

#include "core/model/bus_spec.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast {

class RequestFinder {
 public:
  struct Found {
    std::size_t at = 0, size = 0;  // size 0: not found
    bool certain = true;           // false if a device's response can look the same
  };

  explicit RequestFinder(const BusSpec& bus);

  [[nodiscard]] Found find(ByteView bytes) const;
  // A request or a response.
  [[nodiscard]] bool is_frame(ByteView bytes) const;

 private:
  struct Family {
    std::function<SeenRequest(ByteView)> seen;
    std::function<std::vector<FrameField>(ByteView)> explain;
  };
  std::vector<Family> families_;
};

}  // namespace fieldcast
