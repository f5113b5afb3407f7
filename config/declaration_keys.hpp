// Every key of a declared protocol, by the map that it stands in; a test holds
// config/protocol.schema.json against them.
#pragma once

#include "config/keys.hpp"

namespace fieldcast::config {

extern const KeyTable kDeclarationKeys, kAddressesKeys, kAreaKeys, kOperationKeys, kCountKeys,
    kErrorsKeys, kFieldKeys;

[[nodiscard]] std::span<const KeyTable* const> declaration_key_tables();

}  // namespace fieldcast::config
