// All keys of a declared protocol; a test compares them with config/protocol.schema.json.
#pragma once

#include "config/document/keys.hpp"

namespace fieldcast::config {

extern const KeyTable kDeclarationKeys, kAddressesKeys, kAreaKeys, kOperationKeys, kCountKeys,
    kErrorsKeys, kFieldKeys;

[[nodiscard]] std::span<const KeyTable* const> declaration_key_tables();

}  // namespace fieldcast::config
