// What an address tells by its notation. A line is asked in a protocol that is known; the topics do
// not say which one a device speaks: there the channels of the device tell which built-in families
// it can be, and where these disagree, nothing is guessed. Pure.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/protocol/protocol.hpp"

namespace fieldcast::cli {

// The type of a value at an address where none is said (core/model/implied_type.hpp): "bool" for
// coil:16 and for I0.3, "float32" for float32:12 of DTC; `said` where it is. The error is one line.
[[nodiscard]] tl::expected<std::string, std::string> type_at(std::string_view at,
                                                             const std::string& said,
                                                             const Protocol& protocol);

// A channel of a device as the catalogue has it.
struct KnownChannel {
  std::string at, type;
};
// The same where the protocol is not known. An address that no built-in family has is taken for
// one of a declared protocol: uint16.
[[nodiscard]] tl::expected<std::string, std::string> type_at(
    std::string_view at, const std::string& said, std::span<const KnownChannel> channels);

// With what a device refused such an address: "02 illegal data address", or "code 5A".
[[nodiscard]] std::string device_code_at(std::string_view at, std::uint16_t code);

}  // namespace fieldcast::cli
