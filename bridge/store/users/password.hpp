// Argon2id of libsodium: hashes a password for the store, and verifies a password against a hash.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "bridge/base/secret.hpp"

namespace fieldcast {

// "$argon2id$v=19$m=65536,t=2,p=1$..". The text contains the limits, so they can be raised for new
// hashes. Throws StoreError if memory is not sufficient.
[[nodiscard]] std::string hash_password(std::string_view password);
// Also returns false for a hash without password_limits(), without computing it.
[[nodiscard]] bool password_fits(const std::string& hash, std::string_view password);

// Memory and passes needed to verify against this hash. `std::nullopt` if the text is not a hash,
// or if it needs more than sixteen times as much as hash_password(), so another program wrote it.
struct PasswordLimits {
  std::uint64_t kibibytes = 0;
  std::uint64_t passes = 0;
};
[[nodiscard]] std::optional<PasswordLimits> password_limits(std::string_view hash);

}  // namespace fieldcast
