// Derives types and error codes from the notation of an address. Topics do not contain the
// protocol: the channels of the device limit the possible built-in families. If these differ, the
// user must give the type. Pure.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/protocol/protocol.hpp"

namespace fieldcast::cli {

// Default type at an address (core/model/implied_type.hpp): "bool" for coil:16. `said` has
// priority. The error is one line.
[[nodiscard]] tl::expected<std::string, std::string> type_at(std::string_view at,
                                                             const std::string& said,
                                                             const Protocol& protocol);

struct KnownChannel {
  std::string at, type;
};
// For an unknown protocol. An address of no built-in family is uint16 (declared protocol).
[[nodiscard]] tl::expected<std::string, std::string> type_at(
    std::string_view at, const std::string& said, std::span<const KnownChannel> channels);

// Text of a device error for such an address: "02 illegal data address", or "code 5A".
[[nodiscard]] std::string device_code_at(std::string_view at, std::uint16_t code);

}  // namespace fieldcast::cli
