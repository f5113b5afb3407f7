// Entries of the audit for changes over the API.
#pragma once

#include <string>

#include "tools/station/api/api_routes.hpp"

namespace fieldcast::web {

// Replies and, after a success, adds an entry to the audit.
[[nodiscard]] Reply noting(const Api& api, const Caller& caller, const char* what,
                           const std::string& target, const Reply& reply);

}  // namespace fieldcast::web
