// Derives types and error codes from the notation of an address. On a line the protocol is known.
// Topics do not contain it: the channels of the device limit the possible built-in families, and if
// these differ, the user must give the type. Pure.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/protocol/protocol.hpp"

namespace fieldcast::cli {

// Default type of a value at an address (core/model/implied_type.hpp): "bool" for coil:16 and I0.3,
// "float32" for float32:12 of DTC. `said` has priority. The error is one line.
[[nodiscard]] tl::expected<std::string, std::string> type_at(std::string_view at,
                                                             const std::string& said,
                                                             const Protocol& protocol);

// A channel of a device in the catalogue.
struct KnownChannel {
  std::string at, type;
};
// The same for an unknown protocol. An address of no built-in family belongs to a declared
// protocol: uint16.
[[nodiscard]] tl::expected<std::string, std::string> type_at(
    std::string_view at, const std::string& said, std::span<const KnownChannel> channels);

// Text of a device error for such an address: "02 illegal data address", or "code 5A".
[[nodiscard]] std::string device_code_at(std::string_view at, std::uint16_t code);

}  // namespace fieldcast::cli
