// What devices say of themselves. Harmless: each is a read.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/protocol/protocol.hpp"

namespace fieldcast::cli {

// Modbus function 43, MEI type 14: vendor, product code, revision (Modbus Application Protocol
// V1.1b3, 6.21). Its reply is one range whose items are the text, "Vendor, Product, 1.2".
// Nothing: the protocol is no Modbus.
[[nodiscard]] std::unique_ptr<Exchange> modbus_identity(std::string_view protocol,
                                                        std::uint8_t unit);

// An address in which the device's family keeps its type: D8001 of an FX, SMB6 of an S7-200.
struct TypeAddress {
  std::string_view at;
  std::string_view label;  // "type and version"
};
[[nodiscard]] std::optional<TypeAddress> type_address(std::string_view protocol);

}  // namespace fieldcast::cli
