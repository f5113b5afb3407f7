// A parser of Modbus frames for the tests, independent of the core except checksums.
#pragma once

#include <optional>
#include <string>

#include "core/protocol/modbus/request.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::modbus::reference {

// Content of one whole frame; `std::nullopt` if its marks, lengths or checksum are wrong.
struct Opened {
  std::uint8_t unit = 0;
  std::uint16_t transaction = 0;
  Bytes pdu;
};
[[nodiscard]] std::optional<Opened> open(const std::string& framing, ByteView frame);

// The request that a frame means, and the options with which Fieldcast sends it. `std::nullopt` for
// functions that Fieldcast does not send and for quantities that the standard forbids.
struct Meant {
  Request request;
  Options options;
};
[[nodiscard]] std::optional<Meant> request_of(ByteView pdu);

// Returns a request that `answer` fits: the same number of items, from address 0.
[[nodiscard]] std::optional<Meant> request_for(ByteView answer);

[[nodiscard]] Bytes items_of(ByteView answer, const Request& request);

}  // namespace fieldcast::modbus::reference
