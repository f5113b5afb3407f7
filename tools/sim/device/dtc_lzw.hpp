// LZW over nibbles as a DTC device does it, written apart from the bridge's own.
#pragma once

#include <optional>

#include "core/base/bytes.hpp"

namespace fieldcast::sim {

// Codes, packed into bytes.
[[nodiscard]] Bytes dtc_compress(ByteView message);

// Nothing: these codes do not give `length` bytes. REQUIRES: length <= 4096.
[[nodiscard]] std::optional<Bytes> dtc_expand(ByteView codes, std::size_t length);

}  // namespace fieldcast::sim
