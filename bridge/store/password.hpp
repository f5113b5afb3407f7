// Argon2id of libsodium: makes the text that is kept of a password, and checks a password against
// it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "bridge/base/secret.hpp"

namespace fieldcast {

// "$argon2id$v=19$m=65536,t=2,p=1$..": the limits are in it, so that they can rise for new ones.
// Throws StoreError without memory.
[[nodiscard]] std::string hash_password(std::string_view password);
// False also for a hash without password_limits(): nobody waits for it.
[[nodiscard]] bool password_fits(const std::string& hash, std::string_view password);

// What it takes to check a password against such a text. Nothing: it is none, or one that takes
// more than sixteen times what hash_password() makes, which somebody else wrote into the store.
struct PasswordLimits {
  std::uint64_t kibibytes = 0;
  std::uint64_t passes = 0;
};
[[nodiscard]] std::optional<PasswordLimits> password_limits(std::string_view hash);

}  // namespace fieldcast
