// What devices say of themselves. Harmless: each is a read.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/protocol/protocol.hpp"

namespace fieldcast::cli {

// The question for which a protocol has a message of its own. Its reply is one range whose items
// are the text. Modbus: function 43, MEI type 14, "Vendor, Product, 1.2" (Modbus Application
// Protocol V1.1b3, 6.21); Host Link: omron_identity.hpp. Null: the protocol has none.
[[nodiscard]] std::unique_ptr<Exchange> identity_exchange(std::string_view protocol,
                                                          std::uint16_t address);

// An address in which the device's family keeps its type: D8001 of an FX, SMB6 of an S7-200.
struct TypeAddress {
  std::string_view at;
  std::string_view label;  // "type and version"
};
[[nodiscard]] std::optional<TypeAddress> type_address(std::string_view protocol);

}  // namespace fieldcast::cli
