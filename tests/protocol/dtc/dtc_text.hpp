// DTC written apart from the codec: what tests put into packets and expect in them.
#pragma once

#include <string_view>

#include "core/base/bytes.hpp"

namespace fieldcast::test {

// Address, command and data with their CRC.
[[nodiscard]] Bytes dtc_message(std::string_view hex_without_crc);
// In a plain envelope.
[[nodiscard]] Bytes dtc_plain(const Bytes& message);
// In a compressed one, whether that is shorter or not.
[[nodiscard]] Bytes dtc_compressed(const Bytes& message);
// The message of a packet, either way. Empty: there is none.
[[nodiscard]] Bytes dtc_unpacked(const Bytes& packet);

}  // namespace fieldcast::test
