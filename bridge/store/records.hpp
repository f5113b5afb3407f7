// What the store keeps, row by row. Plain values; names and texts as the topics have them.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/quality.hpp"
#include "core/base/time.hpp"
#include "core/base/value.hpp"

namespace fieldcast {

// Who did what, when, and what became of it: a login, a command, a transmission to a device.
struct AuditEntry {
  UtcTime at;
  std::string who;     // the user, or the requester of a command; with the peer's address where there is one
  std::string what;    // "login", "write", "acquire", "program"
  std::string target;  // "press-shop/press-1/running"; empty: the bridge itself
  std::uint64_t bytes_to_device = 0;
  std::uint64_t bytes_from_device = 0;
  std::string result;  // "done", "refused: wrong password"; one line for people
  friend bool operator==(const AuditEntry&, const AuditEntry&) = default;
};

}  // namespace fieldcast
