// The built-in protocols, one row each. The loader, the JSON Schema, the documents, `fieldcast
// inspect`, the simulator's check and the fuzz targets read these rows: no other file treats a
// protocol by its name. Constant data, any thread.
#pragma once

#include <span>
#include <string_view>

#include "core/protocol/protocol_entry.hpp"

namespace fieldcast {

[[nodiscard]] std::span<const ProtocolEntry> protocols();
[[nodiscard]] const ProtocolEntry* find_protocol(std::string_view name);

[[nodiscard]] DeviceLink link_of(const ProtocolVariant& variant, std::uint16_t address);

}  // namespace fieldcast
