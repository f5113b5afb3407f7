// Argon2id of libsodium: makes the text that is kept of a password, and checks a password against
// it.
#pragma once

#include <string>
#include <string_view>

#include "bridge/base/secret.hpp"

namespace fieldcast {

// "$argon2id$v=19$m=65536,t=2,p=1$..": the limits are in it, so that they can rise for new ones.
// Throws StoreError without memory.
[[nodiscard]] std::string hash_password(std::string_view password);
[[nodiscard]] bool password_fits(const std::string& hash, std::string_view password);

}  // namespace fieldcast
