// The connection string of libpq.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "tools/forward/outlet/postgresql/postgresql_spec.hpp"

namespace fieldcast::forward {

// "postgresql://north:PASSWORD@10.0.0.7:5432/plant?sslmode=verify-full&..". Reads the password file
// and checks the access to the key. Fails with one line with the file, without secrets.
[[nodiscard]] tl::expected<std::string, std::string> connection_text(const PostgresqlSpec& spec);

// RFC 3986, 2.1: each byte that is not unreserved becomes "%2F".
[[nodiscard]] std::string percent_encoded(std::string_view text);

}  // namespace fieldcast::forward
