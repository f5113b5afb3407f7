// Requests that identify a device. Each is a read and changes nothing.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/protocol/protocol.hpp"

namespace fieldcast::cli {

// The protocol's own identification request, whose reply is one range with the text. Modbus:
// function 43, MEI type 14, "Vendor, Product, 1.2" (Modbus Application Protocol V1.1b3, 6.21). Host
// Link: omron_identity.hpp. Null: the protocol has none.
[[nodiscard]] std::unique_ptr<Exchange> identity_exchange(std::string_view protocol,
                                                          std::uint16_t address);

// Address of the device type in a family: D8001 of an FX, SMB6 of an S7-200.
struct TypeAddress {
  std::string_view at;
  std::string_view label;  // "type and version"
};
[[nodiscard]] std::optional<TypeAddress> type_address(std::string_view protocol);

}  // namespace fieldcast::cli
