// Checks a parameter list of discovery or of inline QoS (RTPS 2.2, 9.4.2.11 and 9.6.2) before the
// library parses it. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bridge/dds/guard/rtps_fault.hpp"

namespace fieldcast {

// The parts of a parameter list that the guard uses itself. Spans point into the list.
struct ParameterFacts {
  std::span<const std::uint8_t> participant_guid;  // 16 bytes, or empty
  std::span<const std::uint8_t> endpoint_guid;     // 16 bytes, or empty
  std::span<const std::uint8_t> key_hash;          // 16 bytes, or empty
  std::uint32_t lease_seconds = 0;                 // of a participant
  // The addresses (16 bytes) at which a participant receives.
  std::vector<std::span<const std::uint8_t>> addresses;
  std::uint8_t status = 0;  // of PID_STATUS_INFO: 1 disposed, 2 unregistered
  std::size_t size = 0;     // bytes of the list with its sentinel
  // Offsets in the list of parameters that the library must not parse: descriptions of types and
  // content filters. Fieldcast needs neither; their parsers are the library's weakest.
  std::vector<std::size_t> hidden;
};

// Returns the first fault. `facts` is complete if there is none.
[[nodiscard]] std::optional<RtpsFault> check_parameters(std::span<const std::uint8_t> list,
                                                        bool little, ParameterFacts& facts);

}  // namespace fieldcast
