// Tables of the store, and the upgrade from every older version to the present one.
#pragma once

#include <string>

#include "bridge/store/sql/sql.hpp"

namespace fieldcast {

// Applies the missing steps, each in one transaction, safely also in parallel. Throws StoreError,
// for example for a store of a newer program. `store_name` is for messages.
void bring_to_present(SqlConnection& connection, const std::string& store_name);

[[nodiscard]] std::int64_t present_version();

}  // namespace fieldcast
