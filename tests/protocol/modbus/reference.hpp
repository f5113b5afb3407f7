// A second, independent reading of Modbus frames for the tests: nothing of the core but checksums
// and the value types of protocol.hpp.
#pragma once

#include <optional>
#include <string>

#include "core/protocol/modbus/request.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::modbus::reference {

// What stands inside one whole frame; nothing when its marks, lengths or checksum are wrong.
struct Opened {
  std::uint8_t unit = 0;
  std::uint16_t transaction = 0;
  Bytes pdu;
};
[[nodiscard]] std::optional<Opened> open(const std::string& framing, ByteView frame);

// The request that a master must have meant, and the options under which Fieldcast sends it so;
// nothing for functions that it does not send, or quantities that the standard forbids.
struct Meant {
  Request request;
  Options options;
};
[[nodiscard]] std::optional<Meant> request_of(ByteView pdu);

// A request whose answer `pdu` would be: as many items as it brings, from address 0.
[[nodiscard]] std::optional<Meant> request_for(ByteView answer);

// The items of an answer to `request`.
[[nodiscard]] Bytes items_of(ByteView answer, const Request& request);

}  // namespace fieldcast::modbus::reference
