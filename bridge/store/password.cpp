#include "bridge/store/password.hpp"

#include <sodium.h>

#include <array>

#include "bridge/check.hpp"
#include "bridge/store/sql.hpp"

namespace fieldcast {
namespace {

void start_sodium() {
  static const int started = sodium_init();  // any number of times, from any thread
  FIELDCAST_CHECK(started >= 0);
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

bool password_fits(const std::string& hash, std::string_view password) {
  start_sodium();
  return crypto_pwhash_str_verify(hash.c_str(), password.data(), password.size()) == 0;
}

}  // namespace fieldcast
