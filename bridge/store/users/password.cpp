#include "bridge/store/users/password.hpp"

#include <sodium.h>

#include <array>
#include <charconv>

#include "bridge/base/check.hpp"
#include "bridge/store/sql/sql.hpp"

namespace fieldcast {
namespace {

void start_sodium() {
  static const int started = sodium_init();  // may be called repeatedly, from any thread
  FIELDCAST_CHECK(started >= 0);
}

constexpr std::uint64_t kMostKibibytes = 16 * crypto_pwhash_MEMLIMIT_INTERACTIVE / 1024;
constexpr std::uint64_t kMostPasses = 16 * crypto_pwhash_OPSLIMIT_INTERACTIVE;

// Removes `name` and the following number from the front of `text` and returns the number.
std::optional<std::uint64_t> take_number(std::string_view& text, std::string_view name) {
  if (!text.starts_with(name)) return std::nullopt;
  text.remove_prefix(name.size());
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{}) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

}  // namespace

std::string hash_password(std::string_view password) {
  start_sodium();
  std::array<char, crypto_pwhash_STRBYTES> hash{};
  if (crypto_pwhash_str_alg(hash.data(), password.data(), password.size(),
                            crypto_pwhash_OPSLIMIT_INTERACTIVE, crypto_pwhash_MEMLIMIT_INTERACTIVE,
                            crypto_pwhash_ALG_ARGON2ID13) != 0) {
    throw StoreError("password: no memory for its hash (64 MiB are needed)");
  }
  return hash.data();
}

std::optional<PasswordLimits> password_limits(std::string_view hash) {
  if (!take_number(hash, "$argon2id$v=")) return std::nullopt;
  const auto memory = take_number(hash, "$m="), passes = take_number(hash, ",t=");
  if (!memory || !passes || *memory > kMostKibibytes || *passes > kMostPasses) return std::nullopt;
  return PasswordLimits{*memory, *passes};
}

bool password_fits(const std::string& hash, std::string_view password) {
  start_sodium();
  return password_limits(hash).has_value() &&
         crypto_pwhash_str_verify(hash.c_str(), password.data(), password.size()) == 0;
}

}  // namespace fieldcast
