// The tables of the store, and the way from every older version to the present one.
#pragma once

#include <string>

#include "bridge/store/sql.hpp"

namespace fieldcast {

// Takes the steps that are missing, each whole or not at all, whoever else does the same at this
// moment. Throws StoreError: among others for a store that a newer program made. `store_name` is
// for messages.
void bring_to_present(SqlConnection& connection, const std::string& store_name);

[[nodiscard]] std::int64_t present_version();

}  // namespace fieldcast
