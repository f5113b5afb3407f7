// Finds the request of another master in bytes that this bridge did not ask for, by the protocols
// of its bus; and tells whole frames from noise.
//
// Immutable after construction; pure, any thread. Nothing can fail.
#pragma once

#include <functional>
#include <vector>

#include "core/model/spec.hpp"
#include "core/protocol/registry.hpp"

namespace fieldcast {

class RequestFinder {
 public:
  struct Found {
    std::size_t at = 0, size = 0;  // size 0: none
    bool certain = true;           // false: a device's answer can look the same
  };

  explicit RequestFinder(const BusSpec& bus);

  // The first one; one that is certain before one that is not.
  [[nodiscard]] Found find(ByteView bytes) const;
  // The bytes are one whole frame of a protocol of this bus, a request or an answer.
  [[nodiscard]] bool is_frame(ByteView bytes) const;

 private:
  struct Family {
    std::function<SeenRequest(ByteView)> seen;
    std::function<std::vector<FrameField>(ByteView)> explain;
  };
  std::vector<Family> families_;
};

}  // namespace fieldcast
