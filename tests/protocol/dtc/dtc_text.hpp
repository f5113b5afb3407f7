// DTC implemented independently of the codec: tests build packets and expectations with it.
#pragma once

#include <string_view>

#include "core/base/bytes.hpp"

namespace fieldcast::test {

[[nodiscard]] Bytes dtc_message(std::string_view hex_without_crc);
// Packs a message into a plain envelope.
[[nodiscard]] Bytes dtc_plain(const Bytes& message);
// Packs a message into a compressed envelope, even if that is longer.
[[nodiscard]] Bytes dtc_compressed(const Bytes& message);
// Returns the message of a plain or compressed packet, empty if there is none.
[[nodiscard]] Bytes dtc_unpacked(const Bytes& packet);

}  // namespace fieldcast::test
