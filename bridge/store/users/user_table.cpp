#include "bridge/store/users/user_table.hpp"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <array>

#include "bridge/base/check.hpp"
#include "bridge/store/users/authenticator.hpp"
#include "core/base/message_text.hpp"

namespace fieldcast {

namespace {

constexpr std::string_view kTokenPrefix = "fct_";  // recognizable for users and secret scanners
constexpr std::size_t kTokenBytes = 32;
constexpr int kEncoding = sodium_base64_VARIANT_URLSAFE_NO_PADDING;
constexpr std::size_t kTokenLetters = 43;  // for 32 bytes

void begin_sodium() {
  static const int started = sodium_init();  // may be called repeatedly, from any thread
  FIELDCAST_CHECK(started >= 0);
}

std::string hash_of_token(const std::string& secret) {
  begin_sodium();
  std::array<unsigned char, kTokenBytes> hash{};
  crypto_generichash(hash.data(), hash.size(),
                     reinterpret_cast<const unsigned char*>(secret.data()), secret.size(), nullptr,
                     0);
  std::array<char, 2 * kTokenBytes + 1> text{};
  return sodium_bin2hex(text.data(), text.size(), hash.data(), hash.size());
}

bool in_base64(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_';
}

Token token_of(const SqlRow& row) {
  return {text_at(row, 0), UtcTime{integer_at(row, 1)}, UtcTime{integer_at(row, 2)}};
}

}  // namespace

std::string make_token() {
  begin_sodium();
  std::array<unsigned char, kTokenBytes> random{};
  randombytes_buf(random.data(), random.size());
  std::array<char, kTokenLetters + 1> text{};
  sodium_bin2base64(text.data(), text.size(), random.data(), random.size(), kEncoding);
  std::string token(kTokenPrefix);
  token += text.data();
  sodium_memzero(random.data(), random.size());
  sodium_memzero(text.data(), text.size());
  return token;
}

bool looks_like_token(std::string_view text) {
  return text.size() == kTokenPrefix.size() + kTokenLetters && text.starts_with(kTokenPrefix) &&
         std::all_of(text.begin() + kTokenPrefix.size(), text.end(), in_base64);
}

bool TokenTable::add(const Token& token, const std::string& secret) {
  return connection_.execute(
             "insert into tokens (name, hash, created_at, ends_at) select cast($1 as text), "
             "cast($2 as text), cast($3 as bigint), cast($4 as bigint) where "
             "(select count(*) from tokens) < $5 on conflict do nothing",
             SqlRow{token.name, hash_of_token(secret), token.created_at.nanoseconds,
                    token.ends_at.nanoseconds, static_cast<std::int64_t>(kMaxTokens)}) == 1;
}

bool TokenTable::remove(const std::string& name) {
  return connection_.execute("delete from tokens where name = $1", SqlRow{name}) == 1;
}

std::vector<Token> TokenTable::list() {
  std::vector<Token> tokens;
  connection_.query("select name, created_at, ends_at from tokens order by name", {},
                    [&](const SqlRow& row) {
                      tokens.push_back(token_of(row));
                      return true;
                    });
  return tokens;
}

std::optional<Token> TokenTable::find(const std::string& secret, UtcTime now) {
  std::optional<Token> found;
  connection_.query("select name, created_at, ends_at from tokens where hash = $1 and ends_at > $2",
                    {hash_of_token(secret), now.nanoseconds}, [&](const SqlRow& row) {
                      found = token_of(row);
                      return false;
                    });
  return found;
}

namespace {

// For unknown users, the password is verified against this hash, which costs as much as a real one.
const std::string& nobody() {
  static const std::string hash = hash_password("nobody");
  return hash;
}

// `row` begins with role and created_at. Empty if the role is unknown.
std::optional<User> user_of(const std::string& name, const SqlRow& row) {
  const auto role = role_from(text_at(row, 0));
  if (!role) return std::nullopt;
  return User{name, *role, UtcTime{integer_at(row, 1)}};
}

bool plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_' || c == '.' || c == '@';
}

}  // namespace

bool UserTable::add(const std::string& name, Role role, std::string_view password, UtcTime now) {
  return connection_.execute(
             "insert into users (name, role, password_hash, created_at) values ($1, $2, $3, $4) on "
             "conflict do nothing",
             SqlRow{name, std::string(to_text(role)), hash_password(password), now.nanoseconds}) ==
         1;
}

bool UserTable::remove(const std::string& name) {
  return connection_.execute("delete from users where name = $1", SqlRow{name}) == 1;
}

std::vector<User> UserTable::list() {
  std::vector<User> users;
  connection_.query(
      "select name, role, created_at from users order by name", {}, [&](const SqlRow& row) {
        const auto role = role_from(text_at(row, 1));
        if (!role)
          throw StoreError(fmt::format("store: user {} has the unknown role {}",
                                       printable(text_at(row, 0)), printable(text_at(row, 1))));
        users.push_back({text_at(row, 0), *role, UtcTime{integer_at(row, 2)}});
        return true;
      });
  return users;
}

std::optional<User> UserTable::verify(const std::string& name, std::string_view password) {
  std::string hash = nobody();
  std::optional<User> user;
  connection_.query("select role, created_at, password_hash from users where name = $1",
                    SqlRow{name}, [&](const SqlRow& row) {
                      user = user_of(name, row);
                      hash = text_at(row, 2);
                      return false;
                    });
  return password_fits(hash, password) ? user : std::nullopt;
}

std::optional<User> UserTable::find(const std::string& name) {
  std::optional<User> user;
  connection_.query("select role, created_at from users where name = $1", SqlRow{name},
                    [&](const SqlRow& row) {
                      user = user_of(name, row);
                      return false;
                    });
  return user;
}

std::string fault_of_user_name(std::string_view name) {
  if (!name.empty() && name.size() <= Logins::kMaxUserBytes &&
      std::all_of(name.begin(), name.end(), plain))
    return {};
  return "a user's name has 1 to 64 letters, digits, '-', '_', '.', '@'";
}

std::string fault_of_password(std::string_view password) {
  if (password.size() < Logins::kMinPasswordBytes)
    return fmt::format("a password has at least {} characters", Logins::kMinPasswordBytes);
  if (password.size() > Logins::kMaxPasswordBytes)
    return fmt::format("a password has at most {} bytes", Logins::kMaxPasswordBytes);
  return {};
}

}  // namespace fieldcast
