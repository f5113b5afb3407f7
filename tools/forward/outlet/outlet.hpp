// The seam between the sender and a message engine: an outlet publishes messages and reports each
// acknowledgement or failure. One file and one class for each engine.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/time.hpp"

namespace fieldcast::forward {

struct OutletMessage {
  std::uint64_t record = 0;  // returned in the result
  std::string subject;
  std::string id;  // equal for each repetition; the engine removes duplicates by it
  std::string payload;
};

enum class Outcome : std::uint8_t {
  kAcknowledged,
  kFailed,   // not stored, or unknown: the message must be sent again
  kRefused,  // the engine refuses it every time, for example because it is too large
};

struct OutletResult {
  std::uint64_t record = 0;
  Outcome outcome = Outcome::kFailed;
};

// Used by one thread. Results of a message come once, in any order.
class Outlet {
 public:
  virtual ~Outlet() = default;
  // Connects if necessary. Returns true if messages can be sent. May block for a few seconds.
  [[nodiscard]] virtual bool is_ready(Instant now) = 0;
  // Returns false if the message was not sent; then there is no result.
  [[nodiscard]] virtual bool send(const OutletMessage& message) = 0;
  [[nodiscard]] virtual std::vector<OutletResult> take_results() = 0;
};

}  // namespace fieldcast::forward
